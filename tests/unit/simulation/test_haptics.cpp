// SPDX-License-Identifier: Apache-2.0
// The cut in the hand: the copy knows the depth, the hand cuts more evenly, and is given no more than there
// is.
#include <gtest/gtest.h>

#include "common/workpiece/line_depth.h"
#include "experiments/haptics/felt_cut_trial.h"
#include "experiments/haptics/port_trial.h"
#include "slave/laser/pulsed_beam.h"

namespace telekerf::experiments {
namespace {

TEST(DepthSpeed, IsWhatAStraightLineComesTo) {
  for (const workpiece::Material* material : {&workpiece::kWood, &workpiece::kFibreglass}) {
    for (const double speed_m_per_s : {5e-3, 20e-3}) {
      workpiece::Workpiece piece({.centre_m = Vec2::Zero(), .half_width_m = 2e-3, .pixels = 800}, *material);
      laser::PulsedBeam beam({}, piece);
      constexpr double kPower_w = 5.0, kStep_s = 1e-3;
      Vec2 at(-1.5e-3, 0.0);
      while (at.x() < 1.5e-3) {
        const Vec2 next = at + Vec2(speed_m_per_s * kStep_s, 0.0);
        beam.expose(at, next, kPower_w, kStep_s);
        at = next;
      }
      double depth_m = 0.0;
      constexpr int kPlaces = 100;
      for (int i = 0; i < kPlaces; ++i) depth_m += piece.depth_m({(i - 50) * 1e-5, 0.0}) / kPlaces;
      EXPECT_NEAR(depth_m * speed_m_per_s, workpiece::depth_speed_m2_per_s(*material, kPower_w),
                  0.03 * workpiece::depth_speed_m2_per_s(*material, kPower_w))
          << material->name << " at " << speed_m_per_s;
    }
  }
}

TEST(FeltCut, AHandThatFeelsItCutsMoreEvenlyAndIsGivenNoMoreThanTheTankHolds) {
  const FeltCutTrial trial;
  const FeltCutRun blind = run_felt_cut(trial, false, 1), felt = run_felt_cut(trial, true, 1);
  EXPECT_LT(felt.depth_error, 0.6 * blind.depth_error);
  EXPECT_LT(felt.tracking_rms_um, 1.5 * blind.tracking_rms_um);
  EXPECT_EQ(felt.energy_outside_j, 0.0);
  EXPECT_LE(felt.port_most_given_j, 2e-3);
  // The true force on the true tool; what the constraint's own loop adds is less than this.
  EXPECT_LE(felt.most_given_j, blind.most_given_j + 3e-3);
  EXPECT_GT(felt.felt_rms_n, 0.1);
  EXPECT_EQ(blind.felt_rms_n, 0.0);
}

TEST(Port, OnlyTheTankHoldsWhatComesLateOrFromAnAdversary) {
  constexpr int kRuns = 100;
  for (const bool adversary : {false, true}) {
    const PortResult none = run_port(PortLaw::kNone, adversary, kRuns, 1);
    const PortResult observer = run_port(PortLaw::kObserver, adversary, kRuns, 1);
    const PortResult tank = run_port(PortLaw::kTank, adversary, kRuns, 1);
    EXPECT_GT(none.above, kRuns / 2);
    EXPECT_GT(observer.above, kRuns / 2);
    EXPECT_LT(observer.worst_j, none.worst_j);
    EXPECT_EQ(tank.above, 0);
    EXPECT_LE(tank.worst_j, 1e-12);
    EXPECT_GT(tank.felt_share, 0.1);
  }
}

}  // namespace
}  // namespace telekerf::experiments
