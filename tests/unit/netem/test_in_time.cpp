// SPDX-License-Identifier: Apache-2.0
// What a profile says in time does not change with the packet rate.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "netem/core/decay.h"
#include "netem/core/delay_table.h"
#include "netem/core/loss_chain.h"
#include "netem/verify/verify.h"
#include "tests/unit/netem/round_trips.h"

namespace telekerf::netem {
namespace {

constexpr std::int64_t kMs = 1'000'000;

DirectionProfile of(const std::string& text) { return parse_profile("[both]\n" + text, "test").forward; }

TEST(Decay, IsTheExponential) {
  for (double x = 0.0; x < 700.0; x = 1.07 * x + 1e-5)
    ASSERT_NEAR(decay(3.0 * x, 3.0) / std::exp(-x), 1.0, 1e-13) << x;
  EXPECT_EQ(decay(0.0, 5.0), 1.0);
  EXPECT_EQ(decay(1e18, 1.0), 0.0);
}

/// Correlation of the normal scores behind delays this far apart.
double correlation_over(const DirectionProfile& profile, std::int64_t step_ns, std::int64_t lag_ns) {
  Emulator emulator(profile, {3}, {1U << 16, 0, 0});
  const DelayTable table(profile.stages[0].conditions.delay);
  std::vector<double> scores;
  constexpr std::int64_t kLength_ns = 400'000 * kMs;
  for (std::int64_t now_ns = 0; now_ns < kLength_ns; now_ns += step_ns) {
    while (emulator.pop(now_ns)) {
    }
    scores.push_back(table.normal_score(emulator.push(now_ns, 10U, 0).drawn_ns));
  }
  const auto lag = static_cast<std::size_t>(lag_ns / step_ns);
  double products = 0.0;
  double squares = 0.0;
  for (std::size_t i = lag; i < scores.size(); ++i) {
    products += scores[i] * scores[i - lag];
    squares += 0.5 * (scores[i] * scores[i] + scores[i - lag] * scores[i - lag]);
  }
  return products / squares;
}

TEST(InTime, TheDelaysCorrelationIsTheSameAtEveryRate) {
  const DirectionProfile profile =
      of("delay_ms = 50\njitter_ms = 10\ndistribution = \"normal\"\norder = \"free\"\ncorrelation_ms = 40");
  for (const std::int64_t step_ms : {1, 4, 16}) {
    EXPECT_NEAR(correlation_over(profile, step_ms * kMs, 16 * kMs), std::exp(-0.4), 0.03) << step_ms;
    EXPECT_NEAR(correlation_over(profile, step_ms * kMs, 80 * kMs), std::exp(-2.0), 0.03) << step_ms;
  }
  Emulator emulator(profile, {3});
  const std::int64_t drawn_ns = emulator.push(5 * kMs, 10U, 0).drawn_ns;
  EXPECT_EQ(emulator.push(5 * kMs, 10U, 0).drawn_ns, drawn_ns) << "at the same time, the same delay";
}

TEST(InTime, BurstsOfLossesAreTheSameAtEveryRate) {
  const DirectionProfile profile = of("loss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_ms = 40");
  for (const double step_ms : {0.5, 2.0, 8.0}) {
    Emulator emulator(profile, {3});
    double lost = 0.0;
    double bursts = 0.0;
    bool before = false;
    constexpr double kPackets = 400'000;
    for (double i = 0.0; i < kPackets; i += 1.0) {
      const bool now = emulator.push(static_cast<std::int64_t>(i * step_ms * 1e6), 10U, 0).lost();
      lost += now;
      bursts += now && !before;
      before = now;
      while (emulator.pop(static_cast<std::int64_t>(i * step_ms * 1e6))) {
      }
    }
    EXPECT_NEAR(lost / kPackets, 0.1, 0.01) << step_ms;
    // Of a burst that lasts 40 ms on average packets see a little more: what is left is the chain between
    // two.
    const double nominal = mean_burst(loss_chain(profile.stages[0].conditions.loss, step_ms * 1e-3));
    EXPECT_NEAR(lost / bursts, nominal, 0.05 * nominal) << step_ms;
    EXPECT_NEAR(nominal * step_ms, 40.0, 6.0) << step_ms;
  }
  for (const double rate_hz : {10.0, 1000.0}) {
    Traffic traffic;
    traffic.packets = 50'000;
    traffic.rate_hz = rate_hz;
    EXPECT_TRUE(verify_direction(profile, profile, Direction::kForward, traffic).front().good()) << rate_hz;
  }
  Traffic traffic;
  traffic.packets = 200'000;
  traffic.rate_hz = 125.0;
  const DirectionProfile other = of("loss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_ms = 50");
  EXPECT_FALSE(verify_direction(profile, other, Direction::kForward, traffic).front().good());
}

TEST(Events, HoldPacketsToTheirEnd) {
  const DirectionProfile profile =
      of("delay_ms = 3\n[[event]]\nfirst_s = 1\nevery_s = 2\nduration_ms = 108\nhold = true");
  Emulator emulator(profile, {1});
  EXPECT_EQ(emulator.push(999 * kMs, 10U, 0).due_ns, 1002 * kMs);
  EXPECT_EQ(emulator.push(1000 * kMs, 10U, 0).due_ns, 1111 * kMs);
  EXPECT_EQ(emulator.push(1107 * kMs, 10U, 0).due_ns, 1111 * kMs);
  EXPECT_EQ(emulator.push(1108 * kMs, 10U, 0).due_ns, 1111 * kMs);
  EXPECT_EQ(emulator.push(3100 * kMs, 10U, 0).due_ns, 3111 * kMs);
  Traffic traffic;
  traffic.packets = 20'000;
  EXPECT_TRUE(verify_direction(profile, profile, Direction::kForward, traffic).front().good());
  const DirectionProfile longer =
      of("delay_ms = 3\n[[event]]\nfirst_s = 1\nevery_s = 2\nduration_ms = 109\nhold = true");
  EXPECT_FALSE(verify_direction(profile, longer, Direction::kForward, traffic).front().good());
}

TEST(Events, CoupledOnesDrawAlikeInBothDirections) {
  const Profile profile = parse_profile(
      "[both]\n[[event]]\nfirst_s = -0.5\nevery_s = 1\nduration_ms = 1000\nadd_delay_ms = [10, "
      "20]\ndirection = "
      "\"forward\"\ncoupled = \"sky\"\n[[event]]\nfirst_s = -0.5\nevery_s = 1\nduration_ms = "
      "1000\nadd_delay_ms = "
      "[100, 300]\ndirection = \"backward\"\ncoupled = \"sky\"\n[[event]]\nfirst_s = -0.5\nevery_s = 1\n"
      "duration_ms = 1000\nadd_delay_ms = [0, 1]\ncoupled = \"sea\"\n",
      "test");
  const auto of_word = [](const DirectionProfile& direction, std::size_t event) {
    DirectionProfile one = direction;
    one.events = {direction.events[event]};
    return one;
  };
  const auto draws = [](const DirectionProfile& one, Direction direction, std::uint64_t seed, double least_ms,
                        double range_ms) {
    Emulator emulator(one, {seed, 0, direction});
    std::vector<double> shares;
    for (int s = 0; s < 50; ++s) {
      const PacketOutcome outcome = emulator.push(s * 1000 * kMs, 10U, 0);
      shares.push_back((static_cast<double>(outcome.event_ns) * 1e-6 - least_ms) / range_ms);
    }
    return shares;
  };
  const auto forward = draws(of_word(profile.forward, 0), Direction::kForward, 1, 10.0, 10.0);
  const auto backward = draws(of_word(profile.backward, 0), Direction::kBackward, 1, 100.0, 200.0);
  for (std::size_t i = 0; i < forward.size(); ++i) EXPECT_NEAR(forward[i], backward[i], 1e-6) << i;
  EXPECT_GT(deviation(forward), 0.2) << "a draw each time";
  EXPECT_NE(draws(of_word(profile.forward, 0), Direction::kForward, 2, 10.0, 10.0), forward);
  const auto sea = draws(of_word(profile.forward, 1), Direction::kForward, 1, 0.0, 1.0);
  EXPECT_GT(std::abs(sea[0] - forward[0]) + std::abs(sea[1] - forward[1]), 0.01) << "another word";
}

}  // namespace
}  // namespace telekerf::netem
