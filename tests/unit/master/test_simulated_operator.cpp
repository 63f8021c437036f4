// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "master/operator/simulated_operator.h"

namespace telekerf::master {
namespace {

geometry::Polyline circle() {
  geometry::Polyline line;
  line.closed = true;
  for (int i = 0; i < 720; ++i) {
    line.points_m.emplace_back(0.02 * std::cos(i * M_PI / 360), 0.02 * std::sin(i * M_PI / 360));
  }
  return line;
}

/// A pen that follows the hand ideally along the circle: its tangential pull moves it at speed = pull / 20.
struct Trace {
  double angle = 0.0;
  double largest_push = 0.0;
  double pressed_s = 0.0;
  double sum_force = 0.0;

  explicit Trace(std::uint64_t seed) {
    SimulatedOperator hand(circle(), {}, seed);
    for (int n = 0; n < 30'000; ++n) {
      const Vec3 tool(0.02 * std::cos(angle), 0.02 * std::sin(angle), 0);
      const Vec3 left(-std::cos(angle), -std::sin(angle), 0);
      const Vec3 along(-std::sin(angle), std::cos(angle), 0);
      const HandSample sample = hand.sample(n * 1e-3, tool, Vec3::Zero(), true);
      angle += along.dot(sample.force_n) / 20.0 / 0.02 * 1e-3;
      largest_push = std::max(largest_push, std::abs(left.dot(sample.force_n)));
      pressed_s += sample.trigger ? 1e-3 : 0.0;
      sum_force += sample.force_n.sum();
    }
  }
};

TEST(SimulatedOperator, SameSeedSameHandOtherSeedOtherHand) {
  EXPECT_EQ(Trace(5).sum_force, Trace(5).sum_force);
  EXPECT_NE(Trace(5).sum_force, Trace(6).sum_force);
}

TEST(SimulatedOperator, GoesRoundTheCurvePushesSidewaysAndPressesInStretches) {
  const Trace trace(1);
  EXPECT_GT(trace.angle, 2 * M_PI) << "once round at least in 30 s";
  EXPECT_GT(trace.largest_push, 2.5);
  EXPECT_LT(trace.largest_push, 4.0);
  EXPECT_NEAR(trace.pressed_s / 30.0, SimulatedOperatorSettings{}.press_share, 0.12);
}

TEST(SimulatedOperator, DoesNothingUntilItIsGuided) {
  SimulatedOperator hand(circle(), {}, 1);
  for (int n = 0; n < 100; ++n) {
    const HandSample sample = hand.sample(n * 1e-3, Vec3(0, 0, 0), Vec3::Zero(), false);
    EXPECT_TRUE(sample.force_n.isZero());
    EXPECT_FALSE(sample.trigger);
  }
}

}  // namespace
}  // namespace telekerf::master
