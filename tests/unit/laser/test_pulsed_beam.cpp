// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <utility>

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
  EXPECT_EQ(source.pulse_energy_j(), 1e-3);
  EXPECT_NEAR(energy, 7.3, 1.001e-3) << "but for what is left of one pulse";
  for (const double none : {0.0, -1.0, -1e-300, double{NAN}})
    EXPECT_EQ(source.fire(none, 1.0).count, 0) << none;
  EXPECT_EQ(source.fire(0.0, 1.0).first, 0.0);
  EXPECT_EQ(source.fire(0.0, 1.0).step, 0.0);
  EXPECT_NEAR(source.fire(1e6, 1.0).count, 20000, 1);
  EXPECT_NEAR(source.fire(0.05, 1.0).count, 50, 1) << "however little";
}

TEST(PulsedSource, AsItIsSetItIsTheThesisLaser) {
  const PulsedSource source(PulsedSourceSettings{});
  EXPECT_EQ(source.pulse_energy_j(), 1e-3);
  EXPECT_EQ(source.spot_radius_m(0.0), 30e-6);
  EXPECT_EQ(source.settings().max_power_w, 20.0);
}

/// Binary fractions: pulses of 1 J, 2 W.
TEST(PulsedSource, APulseLeavesAsSoonAsItsEnergyIsThereAndTheRestWaits) {
  PulsedSource source({.max_power_w = 4.0, .repetition_hz = 4.0});
  auto pulses = source.fire(2.0, 1.25);  // 2.5 J
  EXPECT_EQ(pulses.count, 2);
  EXPECT_DOUBLE_EQ(pulses.first, 0.4);
  EXPECT_DOUBLE_EQ(pulses.step, 0.4);
  pulses = source.fire(4.0, 0.25);  // 1 J more, half a one had been left
  EXPECT_EQ(pulses.count, 1);
  EXPECT_DOUBLE_EQ(pulses.first, 0.5);
  EXPECT_EQ(source.fire(1.0, 0.25).count, 0);
  pulses = source.fire(8.0, 0.0625);  // a quarter: at most 4 W
  EXPECT_EQ(pulses.count, 1) << "exactly full";
  EXPECT_DOUBLE_EQ(pulses.first, 1.0);
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

TEST(PulsedBeam, APulseFallsWhereTheBeamIsThenAndIsBookedThere) {
  Workpiece piece = piece_of("wood", 1e-3, 10e-6);
  PulsedBeam beam(PulsedSourceSettings{}, piece);
  const geometry::NearestIndex contour(kLine);
  // Four pulses, at 0, 0.25, 0.5 and 0.75 mm beside the line, and half a millimetre is still inside.
  beam.expose({0, -0.25e-3}, {0, 0.75e-3}, 20.0, 4 / 20e3, &contour, 0.5e-3 + 1e-12);
  EXPECT_NEAR(beam.energy().inside_j, 3e-3, 1e-12);
  EXPECT_NEAR(beam.energy().outside_j, 1e-3, 1e-12);
  for (const double y_m : {0.0, 0.25e-3, 0.5e-3, 0.75e-3})
    EXPECT_GT(piece.depth_m(Vec2(0, y_m)), 0.1e-6) << y_m;
  for (const double y_m : {-0.25e-3, -0.12e-3, 0.12e-3, 0.37e-3, 0.62e-3, 0.9e-3}) {
    EXPECT_EQ(piece.depth_m(Vec2(0, y_m)), 0.0) << y_m;
  }
  beam.expose({2e-3, 0}, {2e-3, 0}, 20.0, 1 / 20e3);
  EXPECT_NEAR(beam.energy().outside_j, 2e-3, 1e-12) << "off the raster, whatever the corridor";
  beam.expose({0, 0.9e-3}, {0, 0.9e-3}, 20.0, 1 / 20e3);
  EXPECT_NEAR(beam.energy().inside_j, 4e-3, 1e-12) << "no corridor: all that is on the raster";
  EXPECT_NEAR(beam.energy().absorbed_j, 0.7 * 6e-3, 1e-12);
}

TEST(PulsedBeam, APulseOnTheCorridorsEdgeIsInside) {
  Workpiece piece = piece_of("wood", 1e-3, 10e-6);
  PulsedBeam beam(PulsedSourceSettings{}, piece);
  const geometry::NearestIndex contour(kLine);
  const double edge_m = std::ldexp(1.0, -11);
  beam.expose({0, edge_m}, {0, edge_m}, 20.0, 1 / 20e3, &contour, edge_m);
  EXPECT_EQ(beam.energy().outside_j, 0.0);
  EXPECT_EQ(beam.energy().inside_j, 1e-3);
}

TEST(PulsedBeam, DefocusedItsPulsesAreWiderAndShallower) {
  const auto depths = [](double defocus_m) {
    Workpiece piece = piece_of("wood", 0.1e-3, 0.5e-6);
    PulsedBeam beam(PulsedSourceSettings{}, piece);
    beam.expose({0, 0}, {0, 0}, 20.0, 1 / 20e3, nullptr, 0.0, defocus_m);
    return std::pair{piece.depth_m(Vec2(0, 0)), cv::countNonZero(piece.depth_m())};
  };
  const auto [deep_m, narrow] = depths(0.0);
  const auto [shallow_m, wide] = depths(-1.8e-3);
  // Absorbed fluence in the middle 2 x 0.7 x 1 mJ / (pi w^2) = 495 kJ/m^2, half of it where the area doubled.
  EXPECT_NEAR(deep_m, (0.7 * 2e-3 / (M_PI * 900e-12) - 300.0) / 60e9, 0.01e-6);
  EXPECT_NEAR(shallow_m, (0.7 * 2e-3 / (M_PI * 1800e-12) - 300.0) / 60e9, 0.01e-6);
  EXPECT_GT(wide, 1.5 * narrow);
}

TEST(PulsedBeam, NothingIsDeeperThanTheWorkpieceIsThick) {
  Workpiece piece = piece_of("fibreglass", 1e-3, 10e-6);
  PulsedBeam beam(PulsedSourceSettings{}, piece);
  beam.expose({0, 0}, {0, 0}, 20.0, 5.0);
  EXPECT_NEAR(piece.depth_m(Vec2(0, 0)), piece.material().thickness_m, 1e-9);
}

TEST(PulsedBeam, ItsKerfIsAboutAsWideAsTheSpotAndEven) {
  const workpiece::MarkAlongPath mark = measure_mark(marked(8e-3, "wood"), kLine, 30e-6);
  EXPECT_NEAR(mark.kerf_m, 37.5e-6, 1.3e-6) << "in steps of a quarter of a pixel to either side";
  EXPECT_LT(mark.depth_variation, 0.001);
}

}  // namespace
}  // namespace telekerf::laser
