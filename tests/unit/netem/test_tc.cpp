// SPDX-License-Identifier: Apache-2.0
// tc export: the command's words, and that whatever they leave out is named.
#include "netem/drivers/tc.h"

#include <gtest/gtest.h>

namespace telekerf::netem {
namespace {

TcExport of(const std::string& keys) {
  return export_to_tc(parse_profile("[both]\n" + keys, "test").forward, "eth0");
}

bool names(const TcExport& out, const std::string& word) {
  for (const auto& line : out.shortcomings) {
    if (line.find(word) != std::string::npos) return true;
  }
  return false;
}

TEST(Tc, WordsOfTheCommand) {
  EXPECT_EQ(of("delay_ms = 50").command, "tc qdisc replace dev eth0 root netem limit 100000 delay 50ms");
  EXPECT_TRUE(of("delay_ms = 50").shortcomings.empty());
  const TcExport hostile = export_to_tc(load_profile("hostile").forward, "eth0");
  EXPECT_NE(hostile.command.find("delay 150ms 60ms distribution normal"), std::string::npos)
      << hostile.command;
  EXPECT_NE(hostile.command.find("loss gemodel 1.38889% 12.5% 100% 0%"), std::string::npos)
      << hostile.command;
  EXPECT_NE(hostile.command.find("duplicate 2% corrupt 1%"), std::string::npos) << hostile.command;
  EXPECT_TRUE(names(hostile, "event"));
  // tc's uniform law is given by its half-width.
  EXPECT_NE(
      of("delay_ms = 20\njitter_ms = 5\ndistribution = \"uniform\"").command.find("delay 20ms 8.66025ms"),
      std::string::npos);
}

TEST(Tc, EveryConditionHasItsWords) {
  const std::string head = "tc qdisc replace dev eth0 root netem limit 100000";
  struct Row {
    const char* keys;
    const char* words;
    std::size_t shortcomings;
  };
  for (const Row& row : {
           Row{"", "", 0},
           Row{"delay_ms = 0.001", " delay 0.001ms", 0},
           Row{"delay_ms = 60\njitter_ms = 5\ndistribution = \"normal\"\norder = \"free\"",
               " delay 60ms 5ms distribution normal", 1},
           Row{"delay_ms = 60\njitter_ms = 5\ndistribution = \"laplace\"\norder = \"free\"",
               " delay 60ms 4.99999ms distribution normal", 2},
           // Gamma of k = 4: its floor and two deviations.
           Row{"delay_ms = 60\njitter_ms = 5\ndistribution = \"gamma\"\nshape = 4\norder = \"free\"",
               " delay 70ms 5ms distribution normal", 2},
           Row{"loss = 0.125", " loss random 12.5%", 1},
           Row{"loss_model = \"gilbert-elliott\"\nge_p = 0.1\nge_r = 0.2\nge_h = 0.3\nge_k = 0.96",
               " loss gemodel 10% 20% 70% 4%", 1},
           Row{"loss_model = \"four-state\"\np13 = 0.1\np31 = 0.2\np32 = 0.3\np23 = 0.4\np14 = 0.05",
               " loss state 10% 20% 30% 40% 5%", 1},
           Row{"delay_ms = 9\norder = \"reorder\"\nreorder = 0.25", " delay 9ms reorder 25%", 2},
           Row{"order = \"reorder\"\nreorder = 0.25", " reorder 25% delay 1ms", 2},
           Row{"delay_ms = 9\nloss = 0.1\ntcp_like = true", " delay 9ms", 2},
           Row{"delay_ms = 9\ntcp_like = true", " delay 9ms", 0},
           Row{"duplicate = 0.5\ncorrupt = 0.25", " duplicate 50% corrupt 25%", 1},

           Row{"slot_ms = 5", " slot 5ms 5ms", 0},
           Row{"slot_ms = 5\nslot_jitter_ms = 2\nslot_packets = 3\nslot_bytes = 1600",
               " slot 5ms 7ms packets 3 bytes 1600", 1},
           Row{"delay_ms = 5\n[[event]]\nduration_ms = 5\nloss = 1", " delay 5ms", 1},
       }) {
    const TcExport out = of(row.keys);
    EXPECT_EQ(out.command, head + row.words) << row.keys;
    EXPECT_EQ(out.shortcomings.size(), row.shortcomings) << row.keys;
  }
  // 10,000 bytes of queue and 50 ms at 100,000 bytes/s: 15,000 bytes, in packets of 200 or 1500.
  const DirectionProfile slow =
      parse_profile("[both]\ndelay_ms = 50\nrate_kbit_per_s = 800\nqueue_bytes = 10000", "test").forward;
  EXPECT_EQ(export_to_tc(slow, "eth0").command,
            "tc qdisc replace dev eth0 root netem limit 75 delay 50ms rate 800kbit");
  EXPECT_EQ(export_to_tc(slow, "eth0", 1500).command,
            "tc qdisc replace dev eth0 root netem limit 10 delay 50ms rate 800kbit");
  EXPECT_TRUE(names(export_to_tc(slow, "eth0", 1500), "1500 bytes"));
  EXPECT_EQ(of("rate_kbit_per_s = 128.5\nqueue_bytes = 64").command,
            "tc qdisc replace dev eth0 root netem limit 1 rate 128.5kbit");
  // One packet in ten lost, in bursts of 32 ms: the chain of packets 16 ms apart.
  const TcExport bursts = of("loss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_ms = 32");
  EXPECT_EQ(bursts.command, head + " loss gemodel 4.26247% 38.3622% 100% 0%");
  EXPECT_TRUE(names(bursts, "loss_burst_ms"));
  DirectionProfile recorded;
  recorded.recording = std::make_shared<Recording>(Recording{{0, 1}});
  EXPECT_EQ(export_to_tc(recorded, "lo").command, "tc qdisc replace dev lo root netem");
  EXPECT_TRUE(names(export_to_tc(recorded, "lo"), "trace"));
  recorded.loss_only = true;
  recorded.stages[0].conditions.loss.model = LossModel::kTrace;
  EXPECT_TRUE(names(export_to_tc(recorded, "lo"), "loss_trace"));
}

TEST(Tc, WhatItLeavesOutIsNamed) {
  EXPECT_TRUE(names(of("delay_ms = 20\njitter_ms = 5\ndistribution = \"normal\""), "order"));
  EXPECT_TRUE(names(of("delay_ms = 20\njitter_ms = 5\ndistribution = \"gamma\"\nshape = 2"), "distribution"));
  EXPECT_TRUE(names(of("delay_ms = 20\njitter_ms = 5\ndistribution = \"normal\"\ncorrelation_ms = 1.442695"),
                    "correlation"));
  EXPECT_TRUE(names(of("delay_ms = 1\njitter_ms = 5\ndistribution = \"normal\""), "below zero"));
  EXPECT_TRUE(names(of("loss = 0.1\ntcp_like = true"), "tcp_like"));
  EXPECT_TRUE(
      names(of("duplicate = 0.1\ndelay_ms = 20\njitter_ms = 5\ndistribution = \"normal\""), "duplicate"));
  EXPECT_TRUE(names(of("rate_kbit_per_s = 100\nqueue_bytes = 1000"), "queue_bytes"));
  EXPECT_TRUE(names(of("delay_ms = 9\norder = \"reorder\"\nreorder = 0.1"), "reorder"));
  EXPECT_TRUE(names(of("delay_ms = 9\n[[stage]]\nfrom_s = 1\n[stage.both]\ndelay_ms = 1"), "stage"));
}

}  // namespace
}  // namespace telekerf::netem
