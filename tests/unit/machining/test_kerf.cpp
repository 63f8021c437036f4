// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/nearest.h"
#include "slave/machining/kerf.h"

namespace telekerf::machining {
namespace {

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
}  // namespace telekerf::machining
