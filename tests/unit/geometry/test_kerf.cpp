// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/kerf.h"
#include "common/geometry/nearest.h"

namespace telekerf::geometry {
namespace {

TEST(Kerf, CompensationMovesTheOutlineOutAndTheHoleIn) {
  Polyline square{{{0, 0}, {10e-3, 0}, {10e-3, 10e-3}, {0, 10e-3}}, true};
  for (const bool reversed : {false, true}) {
    if (reversed) std::reverse(square.points_m.begin(), square.points_m.end());
    const double out = std::abs(signed_area_m2(*compensated(square, 0.1e-3, false)));
    const double in = std::abs(signed_area_m2(*compensated(square, 0.1e-3, true)));
    EXPECT_NEAR(out, 10.1e-3 * 10.1e-3, 5e-9);
    EXPECT_NEAR(in, 9.9e-3 * 9.9e-3, 5e-9);
  }
}

// Outwards corners are rounded, inwards they stay: s^2 + 4 s d + pi d^2 and (s - 2 d)^2.
TEST(Kerf, EveryPointIsMovedByHalfTheKerf) {
  const double side = 10e-3, d = 0.5e-3;
  Polyline square{{{0, 0}, {side, 0}, {side, side}, {0, side}}, true};
  for (const bool reversed : {false, true}) {
    if (reversed) std::reverse(square.points_m.begin(), square.points_m.end());
    const NearestIndex index(square);
    const auto piece = compensated(square, 2.0 * d, false);
    const auto hole = compensated(square, 2.0 * d, true);
    ASSERT_TRUE(piece && hole);
    for (const auto* line : {&*piece, &*hole}) {
      for (const Vec2& p : line->points_m) {
        ASSERT_NEAR(index.find(p).distance_m, d, 2e-3 * d);
        ASSERT_EQ(p.cwiseAbs().maxCoeff() <= side && p.minCoeff() >= 0.0, line == &*hole) << p.transpose();
      }
    }
    const double sense = reversed ? -1.0 : 1.0;
    EXPECT_NEAR(sense * signed_area_m2(*piece), side * side + 4.0 * side * d + M_PI * d * d, 0.01e-6);
    EXPECT_NEAR(sense * signed_area_m2(*hole), (side - 2.0 * d) * (side - 2.0 * d), 0.02e-6);
    // A quarter round in seven pieces, and no more points than the straights need: 10 um apart.
    EXPECT_NEAR(static_cast<double>(piece->size()), 4 * 1000 + 4 * 7, 4);
  }
  // Nothing to do.
  EXPECT_EQ(compensated(square, 0.0, false)->points_m, square.points_m);
  EXPECT_EQ(compensated(square, -1e-3, false)->points_m, square.points_m);
  const Polyline open{square.points_m, false};
  EXPECT_EQ(compensated(open, 1e-3, false)->points_m, open.points_m);
}

TEST(Kerf, AWideKerfReachesAsFarIntoACornerAsItCan) {
  const double half = 0.4e-3;
  const Polyline wedge{{{0, 0}, {10e-3, 0}, {10e-3, 7e-3}}, true};
  const auto hole = compensated(wedge, 2.0 * half, true);
  ASSERT_TRUE(hole);
  const NearestIndex index(wedge);
  for (const Vec2& p : hole->points_m) EXPECT_NEAR(index.find(p).distance_m, half, 1e-6);
  // The corners of the smaller triangle, on the bisectors.
  const NearestIndex moved(*hole);
  const double angle = std::atan2(7.0, 10.0);
  EXPECT_LT(moved.find({half / std::tan(0.5 * angle), half}).distance_m, 15e-6);
  EXPECT_LT(moved.find({10e-3 - half, half}).distance_m, 15e-6);
}

TEST(Kerf, APointWithinTheRoundingOfItsOffsetFromAnotherPartIsLeftOut) {
  // A slot in the right side. What its lower wall moves into it lies at y = 0, this far from its upper wall.
  const double half = std::ldexp(1.0, -12);
  const auto kept = [&](double upper_m) {
    const Polyline comb{{{0, -4e-3},
                         {8e-3, -4e-3},
                         {8e-3, -half},
                         {4e-3, -half},
                         {4e-3, upper_m},
                         {8e-3, upper_m},
                         {8e-3, 4e-3},
                         {0, 4e-3}},
                        true};
    const auto line = compensated(comb, 2.0 * half, false);
    return line ? std::count_if(line->points_m.begin(), line->points_m.end(),
                                [](const Vec2& p) { return p.x() > 5e-3 && p.x() < 7e-3 && p.y() == 0.0; })
                : -1;
  };
  const double bound_m = half * (1.0 - 1e-3);
  EXPECT_EQ(kept(bound_m), 0);
  EXPECT_NEAR(static_cast<double>(kept(std::nextafter(bound_m, 1.0))), 200, 1) << "10 um apart";
}

TEST(Kerf, WhatIsNarrowerThanTheKerfIsRefused) {
  // Two rooms of 3 mm, joined by a passage of 1 mm.
  const Polyline rooms{{{0, 0},
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

TEST(Kerf, WhatTheBeamCannotEnterIsSaid) {
  // A plate of 20 x 10 mm with a slot 5 mm deep.
  const auto plate = [](double slot_m) {
    return Polyline{{{0, 0},
                     {20e-3, 0},
                     {20e-3, 10e-3},
                     {10e-3 + slot_m, 10e-3},
                     {10e-3 + slot_m, 5e-3},
                     {10e-3, 5e-3},
                     {10e-3, 10e-3},
                     {0, 10e-3}},
                    true};
  };
  const double kerf = 0.2e-3;
  EXPECT_EQ(passed_by(plate(0.1e-3), *compensated(plate(0.1e-3), kerf, false), kerf),
            "a slot or notch narrower than the kerf of 0.2 mm is not cut; the deepest is 5.09 mm deep");
  EXPECT_EQ(passed_by(plate(0.4e-3), *compensated(plate(0.4e-3), kerf, false), kerf), "");
  const Polyline open{{{0, 0}, {1, 0}}, false};
  EXPECT_EQ(passed_by(open, open, kerf), "");
  EXPECT_EQ(passed_by(plate(0.1e-3), plate(0.1e-3), 0.0), "");
}

}  // namespace
}  // namespace telekerf::geometry
