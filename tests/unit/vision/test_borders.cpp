// SPDX-License-Identifier: Apache-2.0
// Where borders and middles lie, in fields that are linear across them: there interpolation is exact.
#include <gtest/gtest.h>

#include <cmath>

#include "common/vision/extraction/border.h"
#include "common/vision/extraction/centre_line.h"
#include "common/vision/extraction/contour_extraction.h"
#include "common/vision/extraction/local_level.h"
#include "common/vision/extraction/outline.h"
#include "common/vision/extraction/tangents.h"
#include "tests/unit/vision/fields.h"
#include "tests/unit/vision/truth.h"

namespace telekerf::vision {
namespace {

double square_distance(const Vec2& p, const Vec2& middle) { return (p - middle).cwiseAbs().maxCoeff(); }

TEST(Outline, OfASquareLiesExactlyOnItsBorder) {
  const Vec2 middle(20, 15);
  // 200 - 20 r falls to 110.5 at r = 4.475.
  for (const bool dark : {false, true}) {
    Field field = field_of(41, 31, 110.5,
                           [&](int x, int y) { return slope(std::max(std::abs(x - 20), std::abs(y - 15))); });
    if (dark) {
      field.smooth = 255 - field.smooth;
      field.level = 144.5;
      field.dark = true;
    }
    const Outlines out = outlines_of(field);
    ASSERT_EQ(out.contours.size(), 1u);
    EXPECT_EQ(out.cut_off, 0);
    EXPECT_EQ(out.contours[0].points_px.size(), 36u) << "nine pixels a side";
    for (const Vec2& p : out.contours[0].points_px) EXPECT_NEAR(square_distance(p, middle), 4.475, 1e-12);
    // A square of 8.95 with its corners cut off at 0.475.
    const double area = 8.95 * 8.95 - 2.0 * 0.475 * 0.475;
    const double perimeter = 4.0 * (8.0 + 0.475 * std::sqrt(2.0));
    EXPECT_NEAR(out.areas_px[0], area, 1e-12);
    EXPECT_NEAR(out.width_px, 2.0 * area / perimeter, 1e-12);
    EXPECT_NEAR(out.size_px, 8.95 * std::sqrt(2.0), 1e-12);
    EXPECT_FALSE(out.thin());
  }
}

TEST(Outline, HolesRunTheOtherWayAndCornersThatTouchBelongTogether) {
  const Field ring = field_of(60, 60, 110.5, [](int x, int y) {
    const int r = std::max(std::abs(x - 30), std::abs(y - 30));
    return slope(std::abs(r - 15));
  });
  const Outlines out = outlines_of(ring);
  ASSERT_EQ(out.contours.size(), 2u);
  const double outer = 38.95 * 38.95 - 2.0 * 0.475 * 0.475;
  const double inner =
      21.05 * 21.05;  // within an inner corner no point lies off the square but its corner itself
  EXPECT_NEAR(out.areas_px[0], outer, 1e-9);
  EXPECT_NEAR(-out.areas_px[1], inner, 0.7);
  EXPECT_LT(out.areas_px[1], 0.0);
  EXPECT_NEAR(out.size_px, 38.95 * std::sqrt(2.0), 1e-12) << "of the outer one alone";

  const Field two = field_of(
      20, 20, 100.0, [](int x, int y) { return (x == 9 && y == 9) || (x == 10 && y == 10) ? 200 : 0; });
  EXPECT_EQ(outlines_of(two).contours.size(), 1u);
  const Field apart = field_of(
      20, 20, 100.0, [](int x, int y) { return (x == 9 && y == 9) || (x == 11 && y == 10) ? 200 : 0; });
  EXPECT_EQ(outlines_of(apart).contours.size(), 2u);
}

TEST(Outline, WhatTouchesThePicturesBorderIsCutOffWithItsHoles) {
  // A frame that runs off to the right, with a hole; a square that is whole; one at each edge of the picture.
  for (const auto& [x0, y0] : {std::pair{0, 20}, {57, 20}, {20, 0}, {20, 57}}) {
    const Field field = field_of(60, 60, 100.0, [&, x0 = x0, y0 = y0](int x, int y) {
      const bool cut = x >= x0 && x < x0 + 3 && y >= y0 && y < y0 + 3 && !(x == x0 + 1 && y == y0 + 1);
      const bool whole = x >= 40 && x < 50 && y >= 40 && y < 50;
      return cut || whole ? 200 : 0;
    });
    const Outlines out = outlines_of(field);
    EXPECT_EQ(out.cut_off, 1) << x0 << " " << y0;
    ASSERT_EQ(out.contours.size(), 1u) << x0 << " " << y0;
    EXPECT_NEAR(square_distance(out.contours[0].points_px[0], {44.5, 44.5}), 5.0, 1e-12);
  }
  const Field beside =
      field_of(60, 60, 100.0, [](int x, int y) { return x >= 1 && x < 4 && y >= 1 && y < 4 ? 200 : 0; });
  EXPECT_EQ(outlines_of(beside).cut_off, 0) << "one pixel of background is enough";
}

TEST(Outline, ADiscsBorderIsNeitherInsideNorOutside) {
  for (const double radius : {20.3, 61.7, 140.0}) {
    for (const bool dark : {true, false}) {
      cv::Mat picture(480, 640, CV_8U);  // a border of a blur of one pixel, whatever the radius
      for (int y = 0; y < 480; ++y) {
        for (int x = 0; x < 640; ++x) {
          const double inside = 0.5 * std::erfc((std::hypot(x - 319.7, y - 239.2) - radius) / std::sqrt(2.0));
          picture.at<unsigned char>(y, x) =
              cv::saturate_cast<unsigned char>(dark ? 228 - 188 * inside : 40 + 188 * inside);
        }
      }
      const auto field = make_field(picture);
      ASSERT_TRUE(field);
      const Outlines out = outlines_of(*field);
      ASSERT_EQ(out.contours.size(), 1u);
      double sum = 0.0, most = 0.0;
      for (const Vec2& p : out.contours[0].points_px) {
        const double off = (p - Vec2(319.7, 239.2)).norm() - radius;
        sum += off;
        most = std::max(most, std::abs(off));
      }
      // The field's own blur of one pixel moves a bent border inwards by sigma^2 / (2 r).
      EXPECT_NEAR(sum / static_cast<double>(out.contours[0].points_px.size()), -0.5 / radius, 0.015)
          << radius;
      EXPECT_LT(most, 0.06) << radius;
    }
  }
}

/// A bar between two flanks of 20 grey levels a pixel, from y0 to y1; ends are steep.
Field bar(double left, double right, int y0, int y1) {
  return field_of(120, 200, 100.0, [=](int x, int y) {
    if (y < y0 || y > y1) return 0;
    return static_cast<int>(std::clamp(100.0 + 20.0 * std::min(x - left, right - x), 0.0, 200.0));
  });
}

TEST(CentreLine, IsExactlyBetweenItsBordersWhereverItsRouteRuns) {
  for (const auto& [left, right] : {std::pair{47.0, 59.0}, {48.5, 58.0}, {46.25, 60.0}}) {
    const Field field = bar(left, right, 20, 180);
    for (const double off : {-2.0, -0.3, 0.0, 1.1, 2.4}) {
      Route route;
      for (int y = 30; y <= 170; ++y) route.points_px.emplace_back(0.5 * (left + right) + off, y);
      route.junction.assign(route.points_px.size(), false);
      const PixelContour line = centred(field, route, 12.0);
      EXPECT_NEAR(line.width_px, right - left, 1e-6) << off;
      EXPECT_GT(line.points_px.size(), 100u);
      for (const Vec2& p : line.points_px)
        EXPECT_NEAR(p.x(), 0.5 * (left + right), 1e-3) << left << " " << off;
    }
  }
}

TEST(CentreLine, GoesStraightOnWhereTheRouteIsMarkedAsCrossing) {
  const Field field = bar(47.0, 59.0, 20, 180);
  Route route;
  for (int y = 30; y <= 170; ++y) {
    const bool crossing = y > 95 && y < 105;
    route.points_px.emplace_back(53.0 + (crossing ? 4.0 : 0.5), y);
    route.junction.push_back(crossing);
  }
  for (const Vec2& p : centred(field, route, 12.0).points_px) EXPECT_NEAR(p.x(), 53.0, 0.02) << p.y();
}

TEST(Border, PointsAreMovedOntoItFromEitherSide) {
  const Field field = bar(47.25, 70.0, 5, 195);
  for (const double off : {-3.2, -1.0, -0.2, 0.0, 0.7, 2.3, 3.2}) {
    Route route;
    for (int y = 20; y <= 180; ++y) route.points_px.emplace_back(47.25 + off, y);
    route.junction.assign(route.points_px.size(), false);
    const PixelContour line = on_border(field, route);
    for (const Vec2& p : line.points_px) EXPECT_NEAR(p.x(), 47.25, 1e-6) << off;
  }
}

TEST(LocalLevel, PointsMoveToTheMiddleOfTheirBorder) {
  // A border of a blur of 2 px at x = 60; the field's level lies off its middle by u of its height.
  constexpr double kBlur_px = 2.0;
  for (const double u : {0.25, 0.1, 0.0, -0.1, -0.25}) {
    const Field field = field_of(120, 120, 20.0 + 200.0 * (0.5 - u), [](int x, int) {
      return static_cast<int>(
          std::lround(20.0 + 100.0 * std::erfc((60.0 - x) / (std::sqrt(2.0) * kBlur_px))));
    });
    // A square whose right side runs along the border where the level crosses it, the others far from
    // anything.
    double crossing = 50.0;
    while (field.value(Vec2(crossing, 60.0)) < 0.0) crossing += 0.001;
    std::vector<Vec2> points;
    for (int y = 20; y < 100; ++y) points.emplace_back(crossing, y);
    for (double x = crossing - 1.0; x > 10.0; x -= 1.0) points.emplace_back(x, 100);
    for (int y = 100; y > 20; --y) points.emplace_back(10, y);
    for (double x = 10.0; x < crossing; x += 1.0) points.emplace_back(x, 20);
    move_to_local_level(field, kBlur_px, points);
    EXPECT_NEAR(points[40].x(), 60.0, 0.1) << u << ", from " << crossing;
    EXPECT_EQ(points[40].y(), 60.0);
  }
}

TEST(Stroke, EndsThatNearlyMeetAreJoinedWhereOneGoesOnAsTheOther) {
  drawing::Drawing ring{{{{}, false}}, false, 6.0};  // a circle with a gap of 9 px
  for (int i = 0; i <= 700; ++i) {
    const double a = (2.0 * M_PI - 9.0 / 150.0) * i / 700.0;
    ring.lines_px[0].points_m.emplace_back(319.5 + 150.0 * std::cos(a), 239.5 + 150.0 * std::sin(a));
  }
  drawing::Drawing drop{
      {{{{314.5, 100}, {314.5, 220}}, false}}, false, 6.0};  // a loop on two legs, 10 px apart
  for (int i = 1; i < 300; ++i) {
    const double a = -0.5 * M_PI - 0.07 - (2.0 * M_PI - 0.14) * i / 300.0;
    drop.lines_px[0].points_m.emplace_back(319.5 + 75.0 * std::cos(a), 295.0 + 75.0 * std::sin(a));
  }
  drop.lines_px[0].points_m.insert(drop.lines_px[0].points_m.end(), {{324.5, 220}, {324.5, 100}});
  for (const auto& [drawing, closed] : {std::pair{ring, true}, {drop, false}}) {
    const auto found = extract(drawing::render(drawing, {.noise = 0.0}), {.mode = ExtractionMode::kStroke});
    ASSERT_TRUE(found) << found.error();
    EXPECT_EQ(found->contours.front().closed, closed);
    EXPECT_NEAR(found->contours.front().width_px, 6.3, 0.8);
  }
}

TEST(Tangents, AreChordsOverTheirReach) {
  std::vector<Vec2> p;
  for (int i = 0; i < 12; ++i) p.emplace_back(i, i * i);
  const auto open = tangents_of(p, false, 2);
  const auto chord = [&](std::size_t a, std::size_t b) { return Vec2((p[b] - p[a]).normalized()); };
  for (const auto& [i, a, b] :
       {std::tuple{0, 0, 2}, {1, 0, 3}, {2, 0, 4}, {5, 3, 7}, {10, 8, 11}, {11, 9, 11}})
    EXPECT_NEAR((open[static_cast<std::size_t>(i)] - chord(a, b)).norm(), 0.0, 1e-15) << i;
  const auto closed = tangents_of(p, true, 2);
  for (const auto& [i, a, b] : {std::tuple{0, 10, 2}, {1, 11, 3}, {5, 3, 7}, {10, 8, 0}, {11, 9, 1}})
    EXPECT_NEAR((closed[static_cast<std::size_t>(i)] - chord(a, b)).norm(), 0.0, 1e-15) << i;
  EXPECT_EQ(tangents_of({Vec2(1, 1), Vec2(1, 1)}, false, 1)[0], Vec2(1, 0));
}

}  // namespace
}  // namespace telekerf::vision
