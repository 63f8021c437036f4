// SPDX-License-Identifier: Apache-2.0
// The tool is near a part of the contour: is it the part where it is expected?
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "slave/laser/contour_place.h"

namespace telekerf::laser {
namespace {

/// There and back, 0.6 mm apart: each leg lies in no corridor of the other, but the middle in both.
geometry::NearestIndex hairpin() {
  geometry::Polyline line;
  for (int i = 0; i <= 100; ++i) line.points_m.emplace_back(0.1e-3 * i, 0.0);
  for (int i = 100; i >= 0; --i) line.points_m.emplace_back(0.1e-3 * i, 0.6e-3);
  return geometry::NearestIndex(line);
}

geometry::NearestIndex circle(double radius_m) {
  geometry::Polyline line;
  line.closed = true;
  for (int i = 0; i < 400; ++i) {
    const double angle = i * std::numbers::pi / 200.0;
    line.points_m.emplace_back(radius_m * std::cos(angle), radius_m * std::sin(angle));
  }
  return geometry::NearestIndex(line);
}

TEST(ContourPlace, OnTheOtherLegTheToolIsFarFromWhereItIsExpected) {
  const geometry::NearestIndex contour = hairpin();
  ContourPlace place;
  EXPECT_EQ(place.step(contour, {5e-3, 0.0}, {5e-3, 10e-6}, false).distance_m, 10e-6) << "the first is anew";
  double y = 0.0;
  for (; y < 0.6e-3; y += 10e-6) {
    const Vec2 at_m(5e-3, y);
    const auto now = place.step(contour, at_m, at_m, false);
    ASSERT_NEAR(now.distance_m, y, 1e-9) << "to the leg that it came along, though the other is near";
    ASSERT_NEAR(now.arc_gap_m, 0.0, 1e-9);
  }
  const Vec2 there_m(5e-3, 0.6e-3);
  EXPECT_NEAR(place.step(contour, there_m, there_m, true).distance_m, 0.0, 1e-9) << "anew it may be anywhere";
  EXPECT_NEAR(place.step(contour, there_m, there_m, false).distance_m, 0.0, 1e-9);
}

TEST(ContourPlace, TheGapIsMeasuredAlongTheContourAndRoundIt) {
  const geometry::NearestIndex line = hairpin();
  ContourPlace place;
  EXPECT_NEAR(place.step(line, {5e-3, 0.0}, {5.4e-3, 0.1e-3}, true).arc_gap_m, 0.4e-3, 1e-9);
  EXPECT_NEAR(place.step(line, {5e-3, 0.0}, {4.7e-3, 0.1e-3}, true).arc_gap_m, 0.3e-3, 1e-9);
  const geometry::NearestIndex round = circle(5e-3);
  const Vec2 before(5e-3 * std::cos(-0.02), 5e-3 * std::sin(-0.02));
  const Vec2 after(5e-3 * std::cos(0.02), 5e-3 * std::sin(0.02));
  EXPECT_NEAR(place.step(round, before, after, true).arc_gap_m, 0.2e-3, 1e-6);
  EXPECT_NEAR(place.step(round, after, before, false).arc_gap_m, 0.2e-3, 1e-6);
}

TEST(ContourPlace, FollowsRoundAClosedContourAsOftenAsTheToolGoes) {
  const geometry::NearestIndex contour = circle(5e-3);
  ContourPlace place;
  for (int n = 0; n < 3000; ++n) {
    const double angle = 0.004 * n;
    const Vec2 at_m = 5.1e-3 * Vec2(std::cos(angle), std::sin(angle));
    ASSERT_NEAR(place.step(contour, at_m, at_m, n == 0).distance_m, 0.1e-3, 1e-6) << n;
  }
}

TEST(ContourPlace, AnotherContourIsLookedAtAnew) {
  const geometry::NearestIndex first = hairpin();
  const geometry::NearestIndex second = circle(5e-3);
  ContourPlace place;
  (void)place.step(first, {1e-3, 0.0}, {1e-3, 0.0}, true);
  EXPECT_NEAR(place.step(second, {0.0, -5e-3}, {0.0, -5e-3}, false).distance_m, 0.0, 1e-9);
}

/// A hundred metres a second squared are 0.45 mm in 3 ms.
TEST(ContourPlace, TheToolIsExpectedWhereItsVelocitiesLeadAndAsFarAsItCanBePushed) {
  const geometry::NearestIndex contour = hairpin();
  ContourPlace place;
  const Vec2 at_m(5e-3, 0.1e-3);
  const auto now = place.step(contour, at_m, at_m, true);
  const Vec2 rest = Vec2::Zero();
  const auto predicted = [&](const Vec2& measured, const Vec2& commanded, double acceleration,
                             double enough) {
    return place.predicted_distance_m(contour, now, at_m, measured, commanded, acceleration, 3e-3, enough);
  };
  EXPECT_NEAR(predicted(rest, rest, 0.0, 0.0), 0.1e-3, 1e-12);
  EXPECT_NEAR(predicted(rest, rest, 100.0, 0.0), 0.55e-3, 1e-12);
  EXPECT_NEAR(predicted({0.0, -0.02}, {0.0, -0.02}, 0.0, 0.0), 0.1e-3, 1e-12) << "it is there still";
  EXPECT_NEAR(predicted({0.0, 0.02}, rest, 0.0, 0.0), 0.16e-3, 1e-12);
  EXPECT_NEAR(predicted(rest, {0.0, 0.02}, 0.0, 0.0), 0.16e-3, 1e-12);
  EXPECT_NEAR(predicted({0.1, 0.0}, rest, 0.0, 0.0), 0.1e-3, 1e-12) << "along the line";
  EXPECT_NEAR(predicted({0.1, 0.0}, rest, 0.0, 0.5e-3), 0.4e-3, 1e-12) << "a bound, if it is good enough";
  EXPECT_GT(predicted(rest, rest, 0.0, std::nan("")), 0.09e-3);
  for (const double enough_m : {0.0, 0.5e-3}) {
    EXPECT_TRUE(std::isnan(predicted({std::nan(""), 0.0}, rest, 0.0, enough_m)));
    EXPECT_TRUE(std::isnan(predicted(rest, {0.0, std::nan("")}, 0.0, enough_m)));
  }
}

}  // namespace
}  // namespace telekerf::laser
