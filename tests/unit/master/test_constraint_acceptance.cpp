// SPDX-License-Identifier: Apache-2.0
// The constraint under a hand, on a robot that is ten per cent off its file.
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/constraint/constraint_acceptance.h"

namespace telekerf::experiments {
namespace {

TEST(ConstraintBars, HoldsThreeNewtonsAtThirtyMillimetresASecond) {
  for (const auto& contour : {rounded_outline(1e-3, 20e-3), figure_eight_outline(9e-3)}) {
    TrialSettings settings;
    settings.station.hand_speed_mm_s = 30.0;
    settings.duration_s = 10.0;
    const Trial trial = run_trial(contour, settings);
    EXPECT_LE(trial.rms_m, 1.25e-6) << contour.source;
    EXPECT_LE(trial.max_m, 5.8e-6) << contour.source;
    EXPECT_LE(trial.handover_m(), 60e-9) << contour.source;
    EXPECT_NEAR(trial.travelled_m, 0.2914, 3e-3) << contour.source;
  }
}

TEST(ConstraintBars, TheRobotsErrorDecaysAsEq65Says) {
  const Decay decay = measure_decay(1);
  EXPECT_NEAR(decay.rate_rad_s, decay.chosen_rad_s, 0.05 * decay.chosen_rad_s);
  EXPECT_NEAR(std::abs(decay.error_m.front()), 0.118e-3, 3e-6);
}

TEST(ConstraintBars, TheFreeDirectionIsFreeAndStaysWhereItIsLeft) {
  EXPECT_NEAR(glide_force_n(1), 0.175, 0.01);
  EXPECT_NEAR(breakaway_force_n(1), 0.215, 0.01);
  EXPECT_LE(drift_m_per_s(rounded_outline(1e-3, 20e-3), 1), 60e-9);
}

TEST(ConstraintBars, LettingGoMovesTheToolByLessThanTwentyMicrometres) {
  EXPECT_LE(letting_go_m(rounded_outline(1e-3, 20e-3), 1), 17.5e-6);
}

/// Largest distance from the curve while a hand works at 20 mm/s and then does this for a moment.
double under(const master::OperatorDisturbance& act) {
  TrialSettings settings;
  settings.duration_s = 6.0;
  settings.station.hand.disturbances = {act};
  const Trial trial = run_trial(rounded_outline(1e-3, 20e-3), settings);
  EXPECT_FALSE(trial.saturated);
  EXPECT_FALSE(trial.broken);
  return trial.max_m;
}

TEST(ConstraintBars, ASuddenPushInAnyDirectionMovesTheToolLittle) {
  using Kind = master::OperatorDisturbance::Kind;
  EXPECT_LE(under({Kind::kPush, 2.0, 0.05, 8.0, 0.0, 0.0}), 165e-6);
  EXPECT_LE(under({Kind::kPush, 2.0, 0.05, -8.0, 0.0, 0.0}), 136e-6);
  EXPECT_LE(under({Kind::kPush, 2.0, 0.05, 0.0, 8.0, 0.0}), 49e-6) << "along the curve";
  EXPECT_LE(under({Kind::kPush, 2.0, 0.05, 0.0, 0.0, 8.0}), 49e-6) << "upwards";
}

TEST(ConstraintBars, AWristThatSlipsMovesTheToolLittle) {
  using Kind = master::OperatorDisturbance::Kind;
  EXPECT_LE(under({Kind::kSlip, 2.0, 0.1, 5.0, 0.0, 0.0}), 122e-6);
  EXPECT_LE(under({Kind::kSlip, 2.0, 0.1, -5.0, 3.0, -2.0}), 101e-6);
}

TEST(ConstraintBars, AHandThatFightsInACorridorDoesNotGetToTheEndOfARail) {
  TrialSettings settings;
  settings.duration_s = 5.0;
  settings.station.hand.disturbances = {
      {master::OperatorDisturbance::Kind::kFight, 0.5, 1.5, 35.0, 0.0, 0.0},
      {master::OperatorDisturbance::Kind::kLetGo, 2.0, 100.0, 0.0, 0.0, 0.0}};
  settings.station.corridor_mm = 2.0;
  const Trial trial = run_trial(circle_outline(8e-3), settings);
  EXPECT_FALSE(trial.broken);
  EXPECT_LT(std::abs(trial.off_m.back()), 2.0e-3) << "and is back in it afterwards";
}

TEST(ConstraintBars, SharpCornersCuspsAndStrokesAreHeldAtAnySpeedOfTheHand) {
  ContourMessage star;
  star.source = "star";
  for (int i = 0; i < 10; ++i) {
    const double r = i % 2 == 0 ? 10e-3 : 4e-3;
    star.points_m.emplace_back(r * std::cos(i * M_PI / 5), r * std::sin(i * M_PI / 5));
  }
  ContourMessage zigzag;
  zigzag.source = "zigzag";
  zigzag.closed = false;
  for (int i = 0; i < 9; ++i) zigzag.points_m.emplace_back(-8e-3 + 2e-3 * i, i % 2 == 0 ? -3e-3 : 3e-3);
  ContourMessage heart;  // two arcs that meet in a cusp
  heart.source = "cusp";
  for (int i = 0; i < 400; ++i) {
    const double t = i * 2 * M_PI / 400;
    heart.points_m.emplace_back(
        8e-3 * std::pow(std::sin(t), 3),
        0.5e-3 * (13 * std::cos(t) - 5 * std::cos(2 * t) - 2 * std::cos(3 * t) - std::cos(4 * t)));
  }
  for (const auto& contour : {star, zigzag, heart}) {
    for (const double speed : {10.0, 30.0}) {
      TrialSettings settings;
      settings.station.seed = 2;
      settings.station.hand_speed_mm_s = speed;
      settings.duration_s = 10.0;
      const Trial trial = run_trial(contour, settings);
      EXPECT_LE(trial.rms_m, 17e-6) << contour.source << " " << speed;
      EXPECT_LE(trial.max_m, 75e-6) << contour.source << " " << speed;
      EXPECT_FALSE(trial.saturated) << contour.source << " " << speed;
      EXPECT_GT(trial.travelled_m, speed > 20.0 ? 0.24 : 0.095) << contour.source << " " << speed;
    }
  }
}

TEST(ConstraintBars, AHandStrongerThanTheMotorsGetsItsWayAndTheToolComesBackGently) {
  const Fight weaker = fight(20.0, 1);
  EXPECT_FALSE(weaker.saturated);
  EXPECT_NEAR(weaker.pushed_off_m, 35.8e-6, 2e-6);
  const Fight stronger = fight(60.0, 1);
  EXPECT_TRUE(stronger.saturated);
  EXPECT_FALSE(stronger.broken);
  EXPECT_NEAR(stronger.pushed_off_m, 15.2e-3, 0.4e-3);
  EXPECT_NEAR(stronger.back_s, 0.291, 0.025);
  EXPECT_LT(stronger.overshoot_m, 1e-6) << "nothing wound up";
  EXPECT_LT(stronger.return_m_per_s, 1.02 * master::ConstraintSettings{}.return_m_per_s);
}

/// Seeds 1 to 5 gave 53 to 66 um, and 100 to 128 with an observer that answers all readings alike.
TEST(ConstraintBars, AHandThatLetsGoOf30NewtonDoesNotThrowTheToolToTheOtherSide) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Fight fought = fight(30.0, seed);
    EXPECT_LT(fought.overshoot_m, 72e-6) << seed;
    EXPECT_GT(fought.overshoot_m, 10e-6) << seed;
  }
}

TEST(ConstraintBars, ACorridorIsFreeInsideAndEndsAtAWall) {
  const Region region = measure_region(1);
  EXPECT_NEAR(region.used_m, 0.589e-3, 0.02e-3);
  EXPECT_NEAR(region.beyond_wall_m, 89e-6, 5e-6) << "hit at a tenth of a metre a second";
}

}  // namespace
}  // namespace telekerf::experiments
