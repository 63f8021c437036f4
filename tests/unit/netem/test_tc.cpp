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

TEST(Tc, WhatItLeavesOutIsNamed) {
  EXPECT_TRUE(names(of("delay_ms = 20\njitter_ms = 5\ndistribution = \"normal\""), "order"));
  EXPECT_TRUE(names(of("delay_ms = 20\njitter_ms = 5\ndistribution = \"gamma\"\nshape = 2"), "distribution"));
  EXPECT_TRUE(
      names(of("delay_ms = 20\njitter_ms = 5\ndistribution = \"normal\"\ncorrelation = 0.5"), "correlation"));
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
