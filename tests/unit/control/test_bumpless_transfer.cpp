// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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
      EXPECT_LT((out.velocity_m_per_s - before.velocity_m_per_s).norm(), 2.3e-3) << "change " << change;
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

/// The fade o = (o0 + (v0 + w o0) t) e^(-w t) and its derivatives at any time, in one step or in many.
TEST(BumplessTransfer, FadesAsTheCriticallyDampedOscillatorDoes) {
  struct Start {
    double offset_m, m_per_s, rate_rad_per_s;
  };
  for (const Start& start : {Start{1e-6, 1e-4, 100.0},  // at the full rate
                             Start{4e-4, 0.0, 50.0},    // far: sqrt(1 / 0.4e-3)
                             Start{0.0, 0.02, 25.0},    // fast: 0.5 x 1 / 0.02
                             Start{0.01, -0.02, 10.0}, Start{1e-4, 0.1, 5.0}}) {
    for (const int steps : {1, 7, 40}) {
      BumplessTransfer transfer({});
      KinematicState source{Vec3(0.3, 0, 0), Vec3(0.1, 0, 0), Vec3(0.2, 0, 0)};
      KinematicState from = source;
      from.position_m.x() += start.offset_m;
      from.velocity_m_per_s.x() += start.m_per_s;
      transfer.start(from, source);
      EXPECT_NEAR(transfer.offset_m(), start.offset_m, 1e-15);
      const KinematicState begin = transfer.apply(source, 0.0);
      EXPECT_NEAR(begin.position_m.x(), from.position_m.x(), 1e-15);
      EXPECT_NEAR(begin.velocity_m_per_s.x(), from.velocity_m_per_s.x(), 1e-15);
      constexpr double kT = 0.04;
      KinematicState out;
      for (int n = 0; n < steps; ++n) out = transfer.apply(source, kT / steps);
      const double w = start.rate_rad_per_s;
      const double slope = start.m_per_s + w * start.offset_m;
      const double fade = std::exp(-w * kT);
      const double offset = (start.offset_m + slope * kT) * fade;
      const double rate = slope * fade - w * offset;
      EXPECT_NEAR(out.position_m.x() - 0.3, offset, 1e-12) << steps;
      EXPECT_NEAR(out.velocity_m_per_s.x() - 0.1, rate, 1e-12);
      EXPECT_NEAR(out.acceleration_m_per_s2.x() - 0.2, -2 * w * rate - w * w * offset, 1e-10);
      EXPECT_NEAR(transfer.offset_m(), std::abs(offset), 1e-12);
    }
  }
}

TEST(BumplessTransfer, AFadeAsksForNoMoreThanItsAcceleration) {
  for (const double max : {1.0, 4.0}) {
    for (const double m_per_s : {0.1, 0.3}) {
      BumplessTransfer transfer({.rate_rad_per_s = 100.0, .max_acceleration_m_per_s2 = max});
      transfer.start({.position_m = Vec3::Zero(), .velocity_m_per_s = Vec3(m_per_s, 0, 0)}, {});
      double peak = transfer.apply({}, 0.0).acceleration_m_per_s2.norm();
      for (int n = 0; n < 1000; ++n)
        peak = std::max(peak, transfer.apply({}, 1e-3).acceleration_m_per_s2.norm());
      EXPECT_NEAR(peak, max, 1e-9) << m_per_s << ": 2 w v at its beginning";
      BumplessTransfer far({.rate_rad_per_s = 100.0, .max_acceleration_m_per_s2 = max});
      far.start({.position_m = Vec3(0.1 * m_per_s, 0, 0)}, {});
      EXPECT_NEAR(far.apply({}, 0.0).acceleration_m_per_s2.norm(), max, 1e-9) << "w^2 o at its beginning";
    }
  }
}

TEST(BumplessTransfer, TheWayToRestIsTheFarthestThatAFadeGoes) {
  for (const double m_per_s : {1e-3, 4.9e-3, 5.1e-3, 0.05}) {
    BumplessTransfer transfer({});
    transfer.start({.position_m = Vec3::Zero(), .velocity_m_per_s = Vec3(m_per_s, 0, 0)}, {});
    double farthest_m = 0.0;
    for (int n = 0; n < 20'000; ++n)
      farthest_m = std::max(farthest_m, transfer.apply({}, 1e-4).position_m.x());
    EXPECT_NEAR(transfer.way_to_rest_m(m_per_s), farthest_m, 1e-4 * farthest_m) << m_per_s;
  }
}

}  // namespace
}  // namespace telekerf::control
