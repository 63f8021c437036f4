// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "slave/laser/workpiece.h"

namespace telekerf::laser {
namespace {

TEST(Workpiece, EnergyIsConservedWhereverTheBeamStands) {
  Workpiece workpiece({.half_width_m = 0.01, .pixels = 200, .spot_radius_m = 150e-6});
  double given = 0.0;
  for (int i = 0; i < 500; ++i) {
    const double angle = 0.37 * i;
    workpiece.expose({0.012 * std::cos(angle) * (i % 7) / 6.0, 0.012 * std::sin(angle)}, 0.01);
    given += 0.01;
  }
  EXPECT_NEAR(cv::sum(workpiece.energy_j())[0] + workpiece.outside_raster_j(), given, 1e-5);
  EXPECT_GT(workpiece.outside_raster_j(), 0.0);
}

TEST(Workpiece, UpIsUp) {
  Workpiece workpiece({.half_width_m = 0.01, .pixels = 200, .spot_radius_m = 30e-6});
  workpiece.expose({0.005, 0.008}, 1.0);
  cv::Point brightest;
  cv::minMaxLoc(workpiece.energy_j(), nullptr, nullptr, nullptr, &brightest);
  EXPECT_NEAR(brightest.x, 149.5, 1.0);
  EXPECT_NEAR(brightest.y, 19.5, 1.0);
}

}  // namespace
}  // namespace telekerf::laser
