// SPDX-License-Identifier: Apache-2.0
// Every law and every impairment by the fingerprint of its outcomes, and the counters it leaves: same seed,
// same outcome.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/netem/recorded.h"

namespace telekerf::netem {
namespace {

struct Golden {
  const char* keys;
  std::uint64_t outcomes;
};

constexpr const char* kEvents =
    "\n[[event]]\nfirst_s = 0.5\nevery_s = 1\nduration_ms = 100\nadd_delay_ms = [5, 40]\nloss = 0.3\n"
    "[[event]]\nfirst_s = 1\nduration_ms = 1500\nadd_delay_ms = [1, 2]\n[[event]]\nfirst_s = 3\nduration_ms "
    "= 20\n"
    "loss = 1\n";

const Golden kGolden[] = {
    {"delay_ms = 20\njitter_ms = 6\ndistribution = \"uniform\"\norder = \"free\"", 11281802977701160110U},
    {"delay_ms = 20\njitter_ms = 6\ndistribution = \"normal\"\ncorrelation_ms = 2.803673\norder = \"free\"",
     422395841853196894U},
    {"delay_ms = 2\njitter_ms = 6\ndistribution = \"normal\"", 9827666044961649874U},
    {"delay_ms = 2\njitter_ms = 6\ndistribution = \"laplace\"\norder = \"free\"", 1128190086499333863U},
    {"delay_ms = 20\njitter_ms = 6\ndistribution = \"gamma\"\nshape = 0.4\norder = \"free\"",
     18028807733153369773U},
    {"delay_ms = 20\njitter_ms = 6\ndistribution = \"lognormal\"\nshape = 0.8\norder = \"free\"",
     16987798840015599008U},
    {"delay_ms = 20\njitter_ms = 6\ndistribution = \"pareto\"\nshape = 2.5\norder = \"free\"",
     12395791597623779612U},
    {"delay_ms = 3\ndistribution = \"table\"\ntable_p = [0, 0.6, 0.61, 1]\ntable_ms = [1, 2, 40, "
     "70]\ncorrelation_ms = 0.621335\norder = \"free\"",
     14347547712813323158U},
    {"delay_ms = 9\nloss_model = \"gilbert-elliott\"\nloss = 0.2\nloss_burst_packets = 6",
     16012335781120417882U},
    {"loss_model = \"gilbert-elliott\"\nge_p = 0.05\nge_r = 0.2\nge_h = 0.3\nge_k = 0.9",
     14864592001126775904U},
    {"loss_model = \"four-state\"\np13 = 0.05\np31 = 0.2\np32 = 0.3\np23 = 0.4\np14 = 0.03",
     10916540728139540093U},
    {"delay_ms = 20\norder = \"reorder\"\nreorder = 0.2\nreorder_gap = 5\nduplicate = 0.1\ncorrupt = 0.2",
     10277463851662800217U},
    {"delay_ms = 8\nloss = 0.02\ntcp_like = true\nrto_ms = 30EVENTS", 1708711174651583825U},
    {"delay_ms = 20\njitter_ms = 6\ndistribution = \"normal\"\nloss = 0.1EVENTS", 14329079775133237905U},
    {"delay_ms = 4\nrate_kbit_per_s = 1500\nqueue_bytes = 3000\nloss = 0.1EVENTS", 3654741733242580949U},
    {"delay_ms = 4.3\nslot_ms = 5\nslot_jitter_ms = 2\nslot_packets = 5", 14822814498691639844U},
    {"delay_ms = 4.3\nslot_ms = 3\nslot_bytes = 1500\nloss = 0.3", 16727326253458799791U},
    {"delay_ms = 5\n[[stage]]\nfrom_s = 2\n[stage.both]\ndelay_ms = 7\nloss = 0.5\n[[stage]]\nfrom_s = "
     "4\n[stage.both]\nloss = 0",
     18029414778557058319U},
};

TEST(GoldenLaws, SameSeedSameOutcome) {
  for (const Golden& golden : kGolden) {
    std::string text = golden.keys;
    if (const auto at = text.find("EVENTS"); at != text.npos) text.replace(at, 6, kEvents);
    const DirectionProfile profile = parse_profile("[both]\n" + text, "test").forward;
    const std::uint64_t now = fingerprint(text_of(record(profile, {11, 4}, 6'000)));
    EXPECT_EQ(now, golden.outcomes) << golden.keys;
  }
}

/// Packets of several sizes, many at a time: what slots, bottleneck, copies and damage make of them.
TEST(GoldenLaws, CountersOfABusyLink) {
  const DirectionProfile profile =
      parse_profile(
          "[both]\ndelay_ms = 10\njitter_ms = 4\ndistribution = \"gamma\"\nshape = 2\ncorrelation_ms = "
          "1.442695\n"
          "loss = 0.05\nduplicate = 0.1\ncorrupt = 0.2\nrate_kbit_per_s = 4000\nqueue_bytes = 9000\n"
          "slot_ms = 5\nslot_jitter_ms = 1\nslot_packets = 7\nslot_bytes = 4000\n",
          "test")
          .forward;
  Emulator emulator(profile, {11, 4}, {24, 1U << 16, 1500}, 123'456);
  std::string seen;
  for (int i = 0; i < 4000; ++i) {
    const std::int64_t now_ns = 123'456 + i * std::int64_t{700'000};
    while (const auto delivery = emulator.pop(now_ns)) {
      seen += fmt::format("{} {} {} {:d} {:d}", delivery->tag, delivery->due_ns, delivery->size,
                          delivery->corrupted, delivery->duplicate);
      for (std::size_t k = 0; k < delivery->bytes.size(); ++k) {
        if (delivery->bytes[k] != std::byte{0x5A})
          seen += fmt::format(" {}:{}", k, static_cast<int>(delivery->bytes[k]));
      }
      seen += '\n';
    }
    const std::vector<std::byte> packet(static_cast<std::size_t>(20 + 37 * (i % 31)), std::byte{0x5A});
    const PacketOutcome out = emulator.push(now_ns, packet, static_cast<std::uint64_t>(i));
    seen += fmt::format("{} {} {:d} {:d}\n", out.queued_ns, out.due_ns, out.queue_full, out.overflowed);
  }
  const Counters& c = emulator.counters();
  EXPECT_EQ(fmt::format("{} {} {} {} {} {} {} {}", c.pushed, c.delivered, c.lost, c.queue_full, c.overflowed,
                        c.duplicated, c.corrupted, c.reordered),
            "4000 1546 138 956 1470 105 321 0");
  EXPECT_EQ(fingerprint(seen), 2374964555946585593U);
}

}  // namespace
}  // namespace telekerf::netem
