// SPDX-License-Identifier: Apache-2.0
// Every number of a profile at the last value within its bounds and at the first beyond.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "common/runtime/startup_error.h"
#include "netem/core/loss_chain.h"
#include "netem/core/profile.h"

namespace telekerf::netem {
namespace {

/// Empty: it is taken.
std::string refusal_of(const std::string& text) {
  try {
    (void)parse_profile("[both]\n" + text, "test");
  } catch (const StartupError& refusal) {
    return refusal.what();
  }
  return "";
}

struct Row {
  const char* keys;  ///< with {} where the value stands
  const char* good;
  const char* bad;
  const char* named = "";  ///< the key that the refusal names; empty: the line of the value itself
};

constexpr Row kRows[] = {
    {"delay_ms = {}", "0", "-0.001"},
    {"delay_ms = {}", "60000", "60000.1"},
    {"distribution = \"normal\"\njitter_ms = {}", "60000", "60000.1"},
    {"distribution = \"normal\"\njitter_ms = {}", "0.001", "0"},
    {"distribution = \"normal\"\njitter_ms = 1\ncorrelation_ms = {}", "0", "-0.001"},
    {"distribution = \"normal\"\njitter_ms = 1\ncorrelation_ms = {}", "600000", "600000.1"},
    {"distribution = \"gamma\"\njitter_ms = 1\nshape = {}", "0.1", "0.0999"},
    {"distribution = \"gamma\"\njitter_ms = 1\nshape = {}", "1000", "1001"},
    {"distribution = \"lognormal\"\njitter_ms = 1\nshape = {}", "0.01", "0.0099"},
    {"distribution = \"lognormal\"\njitter_ms = 1\nshape = {}", "3", "3.01"},
    {"distribution = \"pareto\"\njitter_ms = 1\nshape = {}", "2.05", "2.049"},
    {"distribution = \"table\"\ntable_ms = [1, 2]\ntable_p = {}", "[0, 1]", "[0]", "table_p"},
    {"distribution = \"table\"\ntable_ms = [1, 2]\ntable_p = {}", "[0.0, 1.0]", "[0.1, 1]", "table_p"},
    {"distribution = \"table\"\ntable_ms = [1, 2, 2]\ntable_p = {}", "[0, 0.5, 1]", "[0, 0, 1]", "table_p"},
    {"distribution = \"table\"\ntable_p = [0, 0.5, 1]\ntable_ms = {}", "[1, 1, 2]", "[1, 2]", "table_ms"},
    {"distribution = \"table\"\ntable_p = [0, 0.5, 1]\ntable_ms = {}", "[1, 2, 2]", "[1, 2, 1.9]",
     "table_ms"},
    {"loss = {}", "0", "-0.001"},
    {"loss = {}", "1", "1.001"},
    {"loss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_packets = {}", "1", "0.99"},
    {"loss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_packets = {}", "1e6", "1.1e6"},
    {"loss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_ms = {}", "0.01", "0.009"},
    {"loss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_ms = {}", "600000", "600001"},
    {"loss_model = \"gilbert-elliott\"\nloss_burst_packets = 1\nloss = {}", "0.5", "0.51"},
    {"loss_model = \"gilbert-elliott\"\nloss_burst_packets = 4\nloss = {}", "0.8", "0.81"},
    {"loss_model = \"gilbert-elliott\"\nge_p = 0.1\nge_r = {}", "0.001", "0"},
    {"loss_model = \"gilbert-elliott\"\nge_r = 0\nge_p = {}", "0", "0.1", "ge_r"},
    {"loss_model = \"gilbert-elliott\"\nge_p = 0.1\nge_r = 0.1\nge_h = {}", "1", "1.1"},
    {"loss_model = \"gilbert-elliott\"\nge_p = 0.1\nge_r = 0.1\nge_k = {}", "0", "-0.1"},
    {"loss_model = \"four-state\"\np14 = 0.5\np13 = {}", "0.5", "0.501"},
    {"loss_model = \"four-state\"\np13 = 0.1\np32 = 0.5\np23 = 1\np31 = {}", "0.5", "0.501"},
    {"loss_model = \"four-state\"\np13 = 0.1\np31 = {}", "0.01", "0"},
    {"loss_model = \"four-state\"\np13 = 0.1\np31 = 0.1\np32 = 0.1\np23 = {}", "0.01", "0"},
    {"order = \"reorder\"\nreorder = {}", "1", "0"},
    {"order = \"reorder\"\nreorder = 0.1\nreorder_gap = {}", "1", "0"},
    {"order = \"reorder\"\nreorder = 0.1\nreorder_gap = {}", "64", "65"},
    {"tcp_like = true\nrto_ms = {}", "1", "0.9"},
    {"tcp_like = true\nrto_ms = {}", "60000", "60001"},
    {"tcp_like = true\ncorrupt = {}", "0", "0.1"},
    {"duplicate = {}", "1", "1.1"},
    {"corrupt = {}", "1", "1.1"},
    {"queue_bytes = 1000\nrate_kbit_per_s = {}", "1", "0.9"},
    {"queue_bytes = 1000\nrate_kbit_per_s = {}", "1e9", "1.1e9"},
    {"rate_kbit_per_s = 100\nqueue_bytes = {}", "64", "63"},
    {"rate_kbit_per_s = 100\nqueue_bytes = {}", "1000000000", "1000000001"},
    {"slot_ms = {}", "0.01", "0.009"},
    {"slot_ms = {}", "10000", "10001"},
    {"slot_ms = 5\nslot_jitter_ms = {}", "5", "5.1"},
    {"slot_ms = 5\nslot_packets = {}", "1", "0"},
    {"slot_ms = 5\nslot_packets = {}", "1000000", "1000001"},
    {"slot_ms = 5\nslot_bytes = {}", "1500", "1499"},
    {"slot_ms = 5\nslot_bytes = {}", "1000000000", "1000000001"},
    {"[[stage]]\nfrom_s = {}", "0.001", "0"},
    {"[[stage]]\nfrom_s = {}", "1e6", "1.1e6"},
    {"[[stage]]\nfrom_s = 3\n[[stage]]\nfrom_s = {}", "3.1", "3"},
    {"[[event]]\nduration_ms = 1\nloss = 1\nfirst_s = {}", "-1e6", "-1.1e6"},
    {"[[event]]\nduration_ms = 1\nloss = 1\nfirst_s = {}", "1e6", "1.1e6"},
    {"[[event]]\nduration_ms = 1\nloss = 1\nevery_s = {}", "0.01", "0.009"},
    {"[[event]]\nloss = 1\nduration_ms = {}", "0.01", "0.009"},
    {"[[event]]\nloss = 1\nduration_ms = {}", "1e7", "1.1e7"},
    {"[[event]]\nevery_s = 1\nloss = 1\nduration_ms = {}", "1000", "1000.1"},
    {"[[event]]\nduration_ms = 1\nadd_delay_ms = {}", "[2, 2]", "[2, 1.9]"},
    {"[[event]]\nduration_ms = 1\nadd_delay_ms = {}", "[0, 1]", "[0, 0]", "loss"},
    {"[[event]]\nduration_ms = 1\nadd_delay_ms = {}", "[0, 60000]", "[0, 60001]"},
};

TEST(ProfileBounds, TheLastWithinIsTakenAndTheFirstBeyondIsRefused) {
  for (const Row& row : kRows) {
    const std::string keys = row.keys;
    const auto with = [&](const char* value) {
      std::string text = keys;
      return text.replace(text.find("{}"), 2, value);
    };
    EXPECT_EQ(refusal_of(with(row.good)), "") << with(row.good);
    const std::size_t line = keys.rfind('\n', keys.find("{}"));
    std::string named = row.named;
    if (named.empty()) {
      named = keys.substr(line == keys.npos ? 0 : line + 1);
      named = named.substr(0, named.find(' '));
    }
    const std::string refusal = refusal_of(with(row.bad));
    EXPECT_NE(refusal.find("." + named), std::string::npos) << with(row.bad) << ": " << refusal;
  }
}

// A nothing that is written out asks for nothing, wherever it stands.
TEST(ProfileBounds, AWrittenNothingIsNotMisplaced) {
  for (const char* text :
       {"jitter_ms = 0", "distribution = \"constant\"\njitter_ms = 0\ncorrelation_ms = 0",
        "distribution = \"table\"\ntable_p = [0, 1]\ntable_ms = [1, 2]\njitter_ms = 0",
        "tcp_like = true\nduplicate = 0\ncorrupt = 0", "rate_kbit_per_s = 0", "slot_ms = 0"}) {
    EXPECT_EQ(refusal_of(text), "") << text;
  }
}

TEST(ProfileBounds, SixteenEventsAndAnyNumberOfStages) {
  std::string events, stages;
  for (int i = 0; i < 16; ++i) events += "[[event]]\nduration_ms = 1\nloss = 1\n";
  for (int i = 0; i < 3000; ++i)
    stages += fmt::format("[[stage]]\nfrom_s = {}\n[stage.both]\ndelay_ms = {}\n", i + 1, i % 50);
  EXPECT_EQ(refusal_of(events), "");
  EXPECT_EQ(refusal_of(events + "[[event]]\nduration_ms = 1\nloss = 1\n"), "test: more than 16 events");
  const DirectionProfile direction = parse_profile("[both]\nloss = 0.5\n" + stages, "test").backward;
  ASSERT_EQ(direction.stages.size(), 3001u);
  EXPECT_DOUBLE_EQ(direction.stages[3000].conditions.delay.delay_s, 0.049);
  EXPECT_DOUBLE_EQ(direction.stages[3000].conditions.loss.loss, 0.5);
}

TEST(Profile, EventsGoWhereTheyAreDirected) {
  const Profile profile = parse_profile(
      "[both]\n[[event]]\nduration_ms = 1\nloss = 0.1\n[[event]]\nfirst_s = 2\nduration_ms = 20\nevery_s = "
      "3\n"
      "add_delay_ms = [4, 5]\ndirection = \"forward\"\n[[event]]\nduration_ms = 1\nloss = 0.3\n"
      "direction = \"backward\"\n",
      "test");
  ASSERT_EQ(profile.forward.events.size(), 2u);
  ASSERT_EQ(profile.backward.events.size(), 2u);
  const Event& event = profile.forward.events[1];
  EXPECT_DOUBLE_EQ(event.first_s, 2.0);
  EXPECT_DOUBLE_EQ(event.every_s, 3.0);
  EXPECT_DOUBLE_EQ(event.duration_s, 0.020);
  EXPECT_DOUBLE_EQ(event.add_delay_min_s, 0.004);
  EXPECT_DOUBLE_EQ(event.add_delay_max_s, 0.005);
  EXPECT_EQ(event.loss, 0.0);
  EXPECT_DOUBLE_EQ(profile.backward.events[1].loss, 0.3);
}

TEST(Profile, EveryKeyArrivesInItsUnit) {
  const Conditions now =
      parse_profile(
          "[both]\ndelay_ms = 7\njitter_ms = 3\ndistribution = \"lognormal\"\nshape = 0.5\n"
          "correlation_ms = 250\nduplicate = 0.1\ncorrupt = 0.2\nrate_kbit_per_s = 250\n"
          "queue_bytes = 4000\nslot_ms = 6\nslot_jitter_ms = 2\nslot_packets = 9\nslot_bytes = 3000\n",
          "test")
          .forward.stages[0]
          .conditions;
  EXPECT_DOUBLE_EQ(now.delay.delay_s, 0.007);
  EXPECT_DOUBLE_EQ(now.delay.jitter_s, 0.003);
  EXPECT_DOUBLE_EQ(now.delay.shape, 0.5);
  EXPECT_DOUBLE_EQ(now.delay.correlation_s, 0.25);
  EXPECT_DOUBLE_EQ(now.duplicate, 0.1);
  EXPECT_DOUBLE_EQ(now.corrupt, 0.2);
  EXPECT_DOUBLE_EQ(now.rate_bit_per_s, 250e3);
  EXPECT_EQ(now.queue_bytes, 4000);
  EXPECT_DOUBLE_EQ(now.slots.period_s, 0.006);
  EXPECT_DOUBLE_EQ(now.slots.jitter_s, 0.002);
  EXPECT_EQ(now.slots.packets, 9);
  EXPECT_EQ(now.slots.bytes, 3000);
  EXPECT_DOUBLE_EQ(now.rto_s, 0.2);
  EXPECT_EQ(now.loss.model, LossModel::kNone);
}

/// One step of a chain leaves its stationary shares as they are; burst and loss by the long run.
TEST(LossChain, SharesAreStationaryAndBurstsAreLossesOverBeginnings) {
  LossParameters four;
  four.model = LossModel::kFourState;
  four.p13 = 0.05, four.p31 = 0.2, four.p32 = 0.3, four.p23 = 0.4, four.p14 = 0.03;
  LossParameters gilbert;
  gilbert.model = LossModel::kGilbertElliott;
  gilbert.ge_p = 0.05, gilbert.ge_r = 0.2, gilbert.ge_h = 0.3, gilbert.ge_k = 0.9;
  for (const LossParameters& law : {four, gilbert}) {
    const LossChain chain = loss_chain(law);
    double sum = 0.0;
    for (int j = 0; j < chain.states; ++j) {
      double next = 0.0;
      for (int i = 0; i < chain.states; ++i) next += chain.stationary[i] * chain.to[i][j];
      EXPECT_NEAR(next, chain.stationary[j], 1e-15) << j;
      sum += chain.stationary[j];
      double out = 0.0;
      for (int k = 0; k < chain.states; ++k) out += chain.to[j][k];
      EXPECT_NEAR(out, 1.0, 1e-15) << j;
    }
    EXPECT_NEAR(sum, 1.0, 1e-15);
  }
  // Four states: of 1 + 1/4 + 3/16 + 0.03 shares 1/4 and 0.03 are lost; a burst begins from 1 (p13, p14) and
  // 2 (p23).
  EXPECT_NEAR(mean_loss(loss_chain(four)), 0.28 / 1.4675, 1e-12);
  EXPECT_NEAR(mean_burst(loss_chain(four)), 0.28 / (0.08 + 0.1875 * 0.4), 1e-12);
  EXPECT_NEAR(mean_loss(loss_chain(gilbert)), 0.8 * 0.1 + 0.2 * 0.7, 1e-12);
  EXPECT_NEAR(mean_burst(loss_chain(gilbert)),
              0.22 / (0.8 * 0.9 * (0.95 * 0.1 + 0.05 * 0.7) + 0.2 * 0.3 * (0.2 * 0.1 + 0.8 * 0.7)), 1e-12);
}

}  // namespace
}  // namespace telekerf::netem
