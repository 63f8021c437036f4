// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "common/control/bumpless_transfer.h"
#include "common/runtime/vectors.h"

namespace telekerf::control {
namespace {

TEST(BumplessTransfer, NeitherPositionNorVelocityJumpsOnRandomSources) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> position(-0.02, 0.02);
  std::uniform_real_distribution<double> velocity(-0.1, 0.1);
  BumplessTransfer transfer({});
  constexpr double kDt = 1e-3;
  KinematicState source;
  KinematicState out = transfer.apply(source, kDt);
  for (int change = 0; change < 200; ++change) {
    source.position_m = Vec3(position(random), position(random), 0);
    source.velocity_m_per_s = Vec3(velocity(random), velocity(random), 0);
    transfer.start(out, source);
    for (int n = 0; n < 100; ++n) {
      const KinematicState before = out;
      source.position_m += source.velocity_m_per_s * kDt;
      out = transfer.apply(source, kDt);
      // At most what the largest acceleration of the fade makes in a tick.
      EXPECT_LT((out.velocity_m_per_s - before.velocity_m_per_s).norm(), 12e-3) << "change " << change;
      EXPECT_LT((out.position_m - before.position_m).norm(), 0.5e-3);
    }
  }
}

TEST(BumplessTransfer, TheOffsetFadesToNothing) {
  BumplessTransfer transfer({});
  KinematicState from;
  from.position_m = Vec3(0.02, 0, 0);
  transfer.start(from, KinematicState{});
  KinematicState out;
  for (int n = 0; n < 4000; ++n) out = transfer.apply(KinematicState{}, 1e-3);
  EXPECT_LT(out.position_m.norm(), 1e-9);
  EXPECT_LT(transfer.offset_m(), 1e-9);
}

TEST(BumplessTransfer, DerivativesBelongTogether) {
  BumplessTransfer transfer({});
  KinematicState from;
  from.position_m = Vec3(0.001, 0.002, 0);
  from.velocity_m_per_s = Vec3(0.01, 0, 0.02);
  transfer.start(from, KinematicState{});
  constexpr double kDt = 1e-5;
  KinematicState a = transfer.apply(KinematicState{}, kDt);
  for (int n = 0; n < 1000; ++n) {
    const KinematicState b = transfer.apply(KinematicState{}, kDt);
    EXPECT_LT(((b.position_m - a.position_m) / kDt - 0.5 * (a.velocity_m_per_s + b.velocity_m_per_s)).norm(),
              1e-8);
    EXPECT_LT(((b.velocity_m_per_s - a.velocity_m_per_s) / kDt -
               0.5 * (a.acceleration_m_per_s2 + b.acceleration_m_per_s2))
                  .norm(),
              1e-6);
    a = b;
  }
}

}  // namespace
}  // namespace telekerf::control
