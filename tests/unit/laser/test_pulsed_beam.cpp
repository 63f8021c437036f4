// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/workpiece/mark_along_path.h"
#include "slave/laser/pulsed_beam.h"

namespace telekerf::laser {
namespace {

using workpiece::measure_mark;
using workpiece::Workpiece;

Workpiece piece_of(const std::string& name, double half_width_m, double pixel_m) {
  return Workpiece({.half_width_m = half_width_m, .pixels = workpiece::pixels_for(half_width_m, pixel_m)},
                   *workpiece::kMaterials.find(name).value());
}

/// A straight mark along x.
Workpiece marked(double speed_m_per_s, const std::string& name, double power_w = 10.0) {
  Workpiece piece = piece_of(name, 1e-3, 5e-6);
  PulsedBeam beam(PulsedSourceSettings{}, piece);
  const double dt = 1.0 / 2400.0;
  for (double x = -0.8e-3; x < 0.8e-3; x += speed_m_per_s * dt) {
    beam.expose({x, 0}, {x + speed_m_per_s * dt, 0}, power_w, dt);
  }
  return piece;
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

TEST(PulsedBeam, DepthIsInverselyProportionalToSpeed) {
  const double slow = measure_mark(marked(4e-3, "wood"), kLine, 30e-6).depth_m;
  const double fast = measure_mark(marked(16e-3, "wood"), kLine, 30e-6).depth_m;
  EXPECT_NEAR(fast, 191e-6, 2e-6);
  EXPECT_NEAR(slow / fast, 4.0, 0.02);
}

TEST(PulsedBeam, AFastMarkIsAsEvenAsASlowOne) {
  for (const double speed : {8e-3, 50e-3, 100e-3})
    EXPECT_LT(measure_mark(marked(speed, "wood"), kLine, 30e-6).depth_variation, 0.02) << speed;
}

TEST(PulsedBeam, PowerThatFollowsTheSpeedLeavesTheDepth) {
  const double full = measure_mark(marked(16e-3, "wood", 16.0), kLine, 30e-6).depth_m;
  const double slow = measure_mark(marked(4e-3, "wood", 4.0), kLine, 30e-6).depth_m;
  EXPECT_NEAR(slow / full, 1.0, 0.02);
}

TEST(PulsedBeam, JoulesAreAllBookedInsideOrOutsideTheCorridor) {
  Workpiece piece = piece_of("wood", 2e-3, 10e-6);
  PulsedBeam beam(PulsedSourceSettings{}, piece);
  const geometry::NearestIndex contour(kLine);
  beam.expose({0, 0.1e-3}, {0, 0.1e-3}, 10.0, 0.1, &contour, 0.5e-3);
  beam.expose({0, 0.7e-3}, {0, 0.7e-3}, 10.0, 0.05, &contour, 0.5e-3);
  EXPECT_NEAR(beam.energy().inside_j, 1.0, 2e-3);
  EXPECT_NEAR(beam.energy().outside_j, 0.5, 2e-3);
  EXPECT_NEAR(beam.energy().absorbed_j, 0.7 * 1.5, 3e-3);
}

TEST(PulsedBeam, NothingIsDeeperThanTheWorkpieceIsThick) {
  Workpiece piece = piece_of("fibreglass", 1e-3, 10e-6);
  PulsedBeam beam(PulsedSourceSettings{}, piece);
  beam.expose({0, 0}, {0, 0}, 20.0, 5.0);
  EXPECT_LE(piece.depth_m(Vec2(0, 0)), piece.material().thickness_m * (1 + 1e-6));
}

TEST(PulsedBeam, ItsKerfIsAboutAsWideAsTheSpotAndEven) {
  const workpiece::MarkAlongPath mark = measure_mark(marked(8e-3, "wood"), kLine, 30e-6);
  EXPECT_NEAR(mark.kerf_m, 37.5e-6, 1.3e-6) << "in steps of a quarter of a pixel to either side";
  EXPECT_LT(mark.depth_variation, 0.001);
}

}  // namespace
}  // namespace telekerf::laser
