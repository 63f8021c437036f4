// SPDX-License-Identifier: Apache-2.0
// Friction given ahead: what the observer has not seen yet of it, and the laws that both robots share.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/control/friction_feedforward.h"
#include "common/control/tracking_law.h"
#include "common/robot/dynamics.h"

namespace telekerf::control {
namespace {

constexpr DisturbanceObserver::Gains kGains{
    .period_s = 1e-3, .bandwidth_rad_per_s = 300, .velocity_bandwidth_rad_per_s = 900};

robot::Friction friction() {
  return {.coulomb_n = 0.1,
          .breakaway_n = 0.15,
          .viscous_n_s_per_m = 0.3,
          .stribeck_velocity_m_per_s = 5e-3,
          .smoothing_velocity_m_per_s = 5e-4};
}

/// A joint that moves on a sudden at a steady velocity: the observer sees the step through its three poles.
TEST(FrictionFeedforward, GivesWhatThreePolesHaveNotLetThroughYet) {
  const Vec3 velocity(0.01, -0.02, 0.0);
  FrictionFeedforward feedforward(friction(), kGains);
  robot::Friction soft = friction();
  soft.smoothing_velocity_m_per_s = 2e-3;
  const Vec3 seen_n = robot::friction_force(friction(), velocity);
  const Vec3 given_n = robot::friction_force(soft, velocity);
  const double a = std::exp(-0.3);
  const double b = std::exp(-0.9);
  double through[3] = {};
  for (int n = 0; n < 40; ++n) {
    feedforward.update(velocity);
    if (n > 0) {  // what acted over the period before
      through[0] += (1 - a) * (1.0 - through[0]);
      through[1] += (1 - b) * (through[0] - through[1]);
      through[2] += (1 - b) * (through[1] - through[2]);
    }
    ASSERT_LT((feedforward.seen_n() - through[2] * seen_n).norm(), 1e-14) << n;
    ASSERT_LT((feedforward.missing_n() - (1 - through[2]) * given_n).norm(), 1e-14) << n;
  }
  EXPECT_GT(through[2], 0.999);
}

TEST(FrictionFeedforward, ASofterModelIsNotMadeHarder) {
  robot::Friction soft = friction();
  soft.smoothing_velocity_m_per_s = 8e-3;
  FrictionFeedforward feedforward(soft, kGains);
  const Vec3 velocity = Vec3::Constant(1e-3);
  feedforward.update(velocity);
  EXPECT_LT((feedforward.missing_n() - robot::friction_force(soft, velocity)).norm(), 1e-15);
}

TEST(TrackingLaw, IsCriticallyDampedAboutTheGoalsAcceleration) {
  const KinematicState goal{Vec3(1, 2, 3), Vec3(0.1, 0.2, 0.3), Vec3(7, 8, 9)};
  const KinematicState tool{Vec3(0, 4, 3), Vec3(0.4, 0.2, 0.1), Vec3(100, 100, 100)};
  const Vec3 expected(7 + 2 * 5 * -0.3 + 25 * 1, 8 + 25 * -2, 9 + 2 * 5 * 0.2);
  EXPECT_LT((tracking_acceleration(goal, tool, 5.0) - expected).norm(), 1e-12);
}

TEST(TrackingLaw, ALimitKeepsTheDirection) {
  EXPECT_EQ(limited(Vec3(3, 0, -4), 5.0), Vec3(3, 0, -4));
  EXPECT_LT((limited(Vec3(6, 0, -8), 5.0) - Vec3(3, 0, -4)).norm(), 1e-15);
  EXPECT_EQ(limited(Vec3::Zero(), 5.0), Vec3(Vec3::Zero()));
}

TEST(KinematicState, AHeldAccelerationIsIntegratedExactlyAndBack) {
  const KinematicState state{Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(-6, 0, 0)};
  const KinematicState after = advanced(state, 0.5);
  EXPECT_DOUBLE_EQ(after.position_m.x(), 1 + 1 - 0.75);
  EXPECT_DOUBLE_EQ(after.velocity_m_per_s.x(), -1.0);
  EXPECT_EQ(after.acceleration_m_per_s2, state.acceleration_m_per_s2);
  const KinematicState before = preceding(after, state.acceleration_m_per_s2, 0.5);
  EXPECT_DOUBLE_EQ(before.position_m.x(), 1.0);
  EXPECT_DOUBLE_EQ(before.velocity_m_per_s.x(), 2.0);
  EXPECT_EQ(before.acceleration_m_per_s2, state.acceleration_m_per_s2);
  const KinematicState back = advanced(after, -0.5);
  EXPECT_DOUBLE_EQ(back.position_m.x(), 1.0);
}

TEST(DisturbanceObserverLoopDelay, IsKeptWithinWhatItHolds) {
  for (const auto& [asked, kept] : {std::pair{-3, 0}, {0, 0}, {4, 4}, {9, 4}}) {
    DisturbanceObserver::Gains gains = kGains;
    gains.loop_delay = asked;
    DisturbanceObserver observer(gains);
    observer.reset(Vec3::Zero());
    int quiet = 0;
    for (; observer.joint_velocity_m_per_s().isZero(0.0) && quiet < 20; ++quiet) {
      observer.applied(Vec3::Constant(1.0), Mat3::Identity());
      observer.update(Vec3::Zero(), false);
    }
    EXPECT_EQ(quiet, kept + 1) << asked;
    observer.reset(Vec3::Constant(0.1));
    observer.update(Vec3::Zero(), false);
    EXPECT_EQ(observer.joints_m(), Vec3(Vec3::Constant(0.1))) << "nothing is on its way after a reset";
    EXPECT_EQ(observer.disturbance_n(), Vec3(Vec3::Zero()));
    observer.applied(Vec3::Zero(), Mat3::Identity());
    observer.update(Vec3::Zero(), false);
    EXPECT_EQ(observer.joint_velocity_m_per_s(), Vec3(Vec3::Zero()));
  }
}

}  // namespace
}  // namespace telekerf::control
