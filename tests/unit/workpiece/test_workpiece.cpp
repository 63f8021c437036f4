// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "common/workpiece/workpiece.h"

namespace telekerf::workpiece {
namespace {

TEST(Workpiece, EnergyIsConservedWhereverTheBeamStands) {
  Workpiece workpiece({.half_width_m = 0.01, .pixels = 200}, kWood);
  double given = 0.0;
  for (int i = 0; i < 500; ++i) {
    const double angle = 0.37 * i;
    workpiece.absorb({0.012 * std::cos(angle) * (i % 7) / 6.0, 0.012 * std::sin(angle)}, 0.01, 150e-6);
    given += 0.01;
  }
  EXPECT_NEAR(cv::sum(workpiece.energy_j())[0] + workpiece.energy_off_raster_j(), given, 1e-5);
  EXPECT_GT(workpiece.energy_off_raster_j(), 0.0);
}

TEST(Workpiece, WhatNothingHasTouchedIsWhole) {
  const Workpiece workpiece({.half_width_m = 0.01, .pixels = 200}, kWood);
  EXPECT_EQ(cv::countNonZero(workpiece.energy_j()), 0);
  EXPECT_EQ(cv::countNonZero(workpiece.depth_m()), 0);
  EXPECT_EQ(workpiece.depth_m().rows, 200);
  EXPECT_EQ(workpiece.depth_m(Vec2(0, 0)), 0.0);
}

TEST(Workpiece, APulseDigsWhereItFallsAndNoDeeperThanTheMaterialIsThick) {
  Workpiece workpiece({.centre_m = {0.1, -0.2}, .half_width_m = 1e-3, .pixels = 200}, kFibreglass);
  const Vec2 at(0.1 + 0.3e-3, -0.2 + 0.4e-3);
  workpiece.ablate(at, 1e-3, 60e-6);
  const double once = workpiece.depth_m(at);
  EXPECT_GT(once, 0.0);
  EXPECT_EQ(workpiece.depth_m(Vec2(0.1 - 0.3e-3, -0.2 - 0.4e-3)), 0.0);
  workpiece.ablate(at, 1e-3, 60e-6);
  EXPECT_NEAR(workpiece.depth_m(at), 2.0 * once, 1e-9);
  for (int i = 0; i < 1000; ++i) workpiece.ablate(at, 0.1, 60e-6);
  EXPECT_NEAR(workpiece.depth_m(at), workpiece.material().thickness_m, 1e-9);
  EXPECT_TRUE(workpiece.covers(at));
  EXPECT_FALSE(workpiece.covers(Vec2(0, 0)));
}

TEST(Workpiece, UpIsUp) {
  Workpiece workpiece({.half_width_m = 0.01, .pixels = 200}, kWood);
  workpiece.absorb({0.005, 0.008}, 1.0, 30e-6);
  cv::Point brightest;
  cv::minMaxLoc(workpiece.energy_j(), nullptr, nullptr, nullptr, &brightest);
  EXPECT_NEAR(brightest.x, 149.5, 1.0);
  EXPECT_NEAR(brightest.y, 19.5, 1.0);
}

}  // namespace
}  // namespace telekerf::workpiece
