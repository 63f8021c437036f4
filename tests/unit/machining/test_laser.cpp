// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/runtime/startup_error.h"
#include "slave/laser/kerf.h"

namespace telekerf::laser {
namespace {

/// A straight mark along x.
HeightMap marked(double speed_m_per_s, const std::string& name, double power_w = 10.0) {
  HeightMap map({.half_width_m = 1e-3, .pixel_m = 5e-6}, *kMaterials.find(name).value(), PulsedSourceSettings{});
  const double dt = 1.0 / 2400.0;
  for (double x = -0.8e-3; x < 0.8e-3; x += speed_m_per_s * dt) {
    map.expose({x, 0}, {x + speed_m_per_s * dt, 0}, power_w, dt);
  }
  return map;
}

const geometry::Polyline kLine{{{-0.6e-3, 0}, {0.6e-3, 0}}, false};

TEST(PulsedSource, GivesTheEnergyThatIsAskedForInWholePulses) {
  PulsedSource source({.max_power_w = 20, .repetition_hz = 20e3});
  double energy = 0.0;
  for (int i = 0; i < 2400; ++i) energy += source.fire(7.3, 1.0 / 2400.0).count * source.pulse_energy_j();
  EXPECT_NEAR(energy, 7.3, 2e-3);
  EXPECT_EQ(source.fire(0.0, 1.0).count, 0);
  EXPECT_EQ(source.fire(NAN, 1.0).count, 0);
  EXPECT_NEAR(source.fire(1e6, 1.0).count, 20000, 1);
}

TEST(PulsedSource, PulsesAreEvenlySpacedWhateverTheCallsAre) {
  PulsedSource source({.max_power_w = 20, .repetition_hz = 20e3});
  const double dt = 1.0 / 2400.0;
  double last = -1.0;
  for (int i = 0; i < 240; ++i) {
    const auto pulses = source.fire(10.0, dt);
    for (int k = 0; k < pulses.count; ++k) {
      const double share = pulses.first + k * pulses.step;
      ASSERT_GE(share, -1e-9);
      ASSERT_LE(share, 1.0 + 1e-9);
      const double now = (i + share) * dt;
      if (last > 0.0) {
        ASSERT_NEAR(now - last, 1e-4, 1e-9);
      }
      last = now;
    }
  }
}

TEST(PulsedSource, TheSpotWidensAwayFromTheFocus) {
  const PulsedSource source(PulsedSourceSettings{});
  EXPECT_NEAR(source.spot_radius_m(1.8e-3) / source.spot_radius_m(0.0), std::sqrt(2.0), 1e-12);
}

TEST(HeightMap, DepthIsInverselyProportionalToSpeed) {
  const double slow = measure_mark(marked(4e-3, "wood"), kLine, 30e-6).depth_m;
  const double fast = measure_mark(marked(16e-3, "wood"), kLine, 30e-6).depth_m;
  EXPECT_GT(fast, 10e-6);
  EXPECT_NEAR(slow / fast, 4.0, 0.08);
}

TEST(HeightMap, AFastMarkIsAsEvenAsASlowOne) {
  for (const double speed : {8e-3, 50e-3, 100e-3})
    EXPECT_LT(measure_mark(marked(speed, "wood"), kLine, 30e-6).depth_variation, 0.05) << speed;
}

TEST(HeightMap, PowerThatFollowsTheSpeedLeavesTheDepth) {
  const double full = measure_mark(marked(16e-3, "wood", 16.0), kLine, 30e-6).depth_m;
  const double slow = measure_mark(marked(4e-3, "wood", 4.0), kLine, 30e-6).depth_m;
  EXPECT_NEAR(slow / full, 1.0, 0.02);
}

TEST(HeightMap, JoulesAreAllBookedInsideOrOutsideTheCorridor) {
  HeightMap map({.half_width_m = 2e-3, .pixel_m = 10e-6}, kWood, PulsedSourceSettings{});
  const geometry::NearestIndex contour(kLine);
  map.expose({0, 0.1e-3}, {0, 0.1e-3}, 10.0, 0.1, 0.0, &contour, 0.5e-3);
  map.expose({0, 0.7e-3}, {0, 0.7e-3}, 10.0, 0.05, 0.0, &contour, 0.5e-3);
  EXPECT_NEAR(map.energy().inside_j, 1.0, 2e-3);
  EXPECT_NEAR(map.energy().outside_j, 0.5, 2e-3);
  EXPECT_NEAR(map.energy().absorbed_j, 0.7 * 1.5, 3e-3);
}

TEST(HeightMap, NothingIsDeeperThanTheWorkpieceIsThick) {
  HeightMap map({.half_width_m = 1e-3, .pixel_m = 10e-6}, kFibreglass, PulsedSourceSettings{});
  map.expose({0, 0}, {0, 0}, 20.0, 5.0);
  EXPECT_LE(map.depth_at({0, 0}), kFibreglass.thickness_m * (1 + 1e-6));
}

TEST(Kerf, IsAboutAsWideAsTheSpotAndEven) {
  const MarkAlongPath mark = measure_mark(marked(8e-3, "wood"), kLine, 30e-6);
  EXPECT_GT(mark.kerf_m, 25e-6);
  EXPECT_LT(mark.kerf_m, 70e-6);
  EXPECT_LT(mark.depth_variation, 0.05);
}

TEST(Kerf, CompensationMovesTheOutlineOutAndTheHoleIn) {
  geometry::Polyline square{{{0, 0}, {10e-3, 0}, {10e-3, 10e-3}, {0, 10e-3}}, true};
  for (const bool reversed : {false, true}) {
    if (reversed) std::reverse(square.points_m.begin(), square.points_m.end());
    const double out = std::abs(geometry::signed_area_m2(*compensated(square, 0.1e-3, false)));
    const double in = std::abs(geometry::signed_area_m2(*compensated(square, 0.1e-3, true)));
    EXPECT_NEAR(out, 10.1e-3 * 10.1e-3, 5e-9);
    EXPECT_NEAR(in, 9.9e-3 * 9.9e-3, 5e-9);
  }
}

TEST(Kerf, AWideKerfReachesAsFarIntoACornerAsItCan) {
  const double half = 0.4e-3;
  const geometry::Polyline wedge{{{0, 0}, {10e-3, 0}, {10e-3, 7e-3}}, true};
  const auto hole = compensated(wedge, 2.0 * half, true);
  ASSERT_TRUE(hole);
  const geometry::NearestIndex index(wedge);
  for (const Vec2& p : hole->points_m) EXPECT_NEAR(index.find(p).distance_m, half, 1e-6);
  // The corners of the smaller triangle, on the bisectors.
  const geometry::NearestIndex moved(*hole);
  const double angle = std::atan2(7.0, 10.0);
  EXPECT_LT(moved.find({half / std::tan(0.5 * angle), half}).distance_m, 15e-6);
  EXPECT_LT(moved.find({10e-3 - half, half}).distance_m, 15e-6);
}

TEST(Kerf, WhatIsNarrowerThanTheKerfIsRefused) {
  // Two rooms of 3 mm, joined by a passage of 1 mm.
  const geometry::Polyline rooms{{{0, 0},
                                  {3e-3, 0},
                                  {3e-3, 1e-3},
                                  {5e-3, 1e-3},
                                  {5e-3, 0},
                                  {8e-3, 0},
                                  {8e-3, 3e-3},
                                  {5e-3, 3e-3},
                                  {5e-3, 2e-3},
                                  {3e-3, 2e-3},
                                  {3e-3, 3e-3},
                                  {0, 3e-3}},
                                 true};
  EXPECT_TRUE(compensated(rooms, 0.8e-3, true));
  EXPECT_TRUE(compensated(rooms, 1.3e-3, false));
  const auto passage = compensated(rooms, 1.3e-3, true);
  ASSERT_FALSE(passage);
  EXPECT_NE(passage.error().find("--kerf-um"), std::string::npos) << passage.error();
  EXPECT_FALSE(compensated(rooms, 4e-3, true)) << "nothing is left of it";
}

}  // namespace
}  // namespace telekerf::laser
