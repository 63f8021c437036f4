// SPDX-License-Identifier: Apache-2.0
// The constraint under a hand, on a robot that is ten per cent off its file.
#include <gtest/gtest.h>

#include "tests/experiments/constraint_bars.h"

namespace telekerf::experiments {
namespace {

TEST(ConstraintBars, HoldsThreeNewtonsAtThirtyMillimetresASecond) {
  for (const auto& contour : {rounded_outline(1e-3, 20e-3), figure_eight_outline(9e-3)}) {
    TrialSettings settings;
    settings.station.hand_speed_mm_s = 30.0;
    settings.duration_s = 10.0;
    const Trial trial = run_trial(contour, settings);
    EXPECT_LE(trial.rms_m, 30e-6) << contour.source;
    EXPECT_LE(trial.max_m, 150e-6) << contour.source;
    EXPECT_LE(trial.max_handover_m_per_s, 0.1e-3) << contour.source;
    EXPECT_GT(trial.travelled_m, 0.15) << contour.source;
  }
}

TEST(ConstraintBars, TheRobotsErrorDecaysAsEq65Says) {
  const Decay decay = measure_decay(1);
  EXPECT_NEAR(decay.rate_rad_s, decay.chosen_rad_s, 0.05 * decay.chosen_rad_s);
  EXPECT_GT(std::abs(decay.error_m.front()), 0.4e-3);
}

TEST(ConstraintBars, TheFreeDirectionIsFreeAndStaysWhereItIsLeft) {
  EXPECT_LE(glide_force_n(1), 0.3);
  EXPECT_LE(breakaway_force_n(1), 0.3);
  EXPECT_LE(drift_m_per_s(rounded_outline(1e-3, 20e-3), 1), 1e-6);
}

TEST(ConstraintBars, LettingGoMovesTheToolByLessThanATenthOfAMillimetre) {
  EXPECT_LE(letting_go_m(rounded_outline(1e-3, 20e-3), 1), 100e-6);
}

TEST(ConstraintBars, AHandStrongerThanTheMotorsGetsItsWayAndTheToolComesBackGently) {
  const Fight weaker = fight(20.0, 1);
  EXPECT_FALSE(weaker.saturated);
  EXPECT_LT(weaker.pushed_off_m, 1e-3);
  const Fight stronger = fight(60.0, 1);
  EXPECT_TRUE(stronger.saturated);
  EXPECT_FALSE(stronger.broken);
  EXPECT_GT(stronger.pushed_off_m, 1e-3);
  EXPECT_LT(stronger.back_s, 3.0);
  EXPECT_LT(stronger.overshoot_m, 0.1e-3) << "nothing wound up";
}

TEST(ConstraintBars, ACorridorIsFreeInsideAndEndsAtAWall) {
  const Region region = measure_region(1);
  EXPECT_GT(region.used_m, 0.3e-3);
  EXPECT_LT(region.beyond_wall_m, 0.3e-3) << "hit at a tenth of a metre a second";
}

}  // namespace
}  // namespace telekerf::experiments
