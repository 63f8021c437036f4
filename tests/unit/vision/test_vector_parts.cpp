// SPDX-License-Identifier: Apache-2.0
// The parts that the readers of vector files are made of, each on its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "common/vision/vector/drawn_lines.h"
#include "common/vision/vector/dxf/blocks.h"
#include "common/vision/vector/joining.h"
#include "common/vision/vector/number.h"
#include "common/vision/vector/spline.h"
#include "common/vision/vector/svg/document.h"
#include "common/vision/vector/svg/lengths.h"
#include "common/vision/vector/svg/path_data.h"
#include "common/vision/vector/svg/transform.h"
#include "common/vision/vector/svg/view_box.h"

namespace telekerf::vision {
namespace {

using Kind = PathSegment::Kind;

std::vector<PathSegment> segments_of(std::string_view d) {
  PathData data(d);
  std::vector<PathSegment> out;
  while (const auto segment = data.next()) out.push_back(*segment);
  EXPECT_FALSE(data.damaged()) << d << " near " << data.rest();
  return out;
}

TEST(SvgPath, ShortFormsAreSpeltOut) {
  const auto s = segments_of("m1 2 3 4h5V1 2zl1 0S7 8 9 9s1 2 3 3Q20 10 30 10T50 12t1 1");
  const std::vector<std::tuple<Kind, Vec2, Vec2>> expected{
      {Kind::kMove, {0, 0}, {1, 2}},          {Kind::kLine, {1, 2}, {4, 6}},
      {Kind::kLine, {4, 6}, {9, 6}},          {Kind::kLine, {9, 6}, {9, 1}},
      {Kind::kLine, {9, 1}, {9, 2}},          {Kind::kClose, {9, 2}, {1, 2}},
      {Kind::kLine, {1, 2}, {2, 2}},          {Kind::kCubic, {2, 2}, {9, 9}},
      {Kind::kCubic, {9, 9}, {12, 12}},       {Kind::kQuadratic, {12, 12}, {30, 10}},
      {Kind::kQuadratic, {30, 10}, {50, 12}}, {Kind::kQuadratic, {50, 12}, {51, 13}}};
  ASSERT_EQ(s.size(), expected.size());
  for (std::size_t i = 0; i < s.size(); ++i) {
    EXPECT_EQ(std::tuple(s[i].kind, s[i].from, s[i].to), expected[i]) << i;
  }
  EXPECT_EQ(s[7].a, Vec2(2, 2));    // no curve before: nothing to continue
  EXPECT_EQ(s[8].a, Vec2(11, 10));  // the last control point beyond the joint
  EXPECT_EQ(s[8].b, Vec2(10, 11));
  EXPECT_EQ(s[10].a, Vec2(40, 10));
  EXPECT_EQ(s[11].a, Vec2(60, 14));
}

TEST(SvgPath, ArcsKeepTheirFlags) {
  const auto s = segments_of("M1 1A3 4 90 1 0 5 6a3 4 0 01.5-1");
  ASSERT_EQ(s.size(), 3u);
  EXPECT_EQ(s[1].radii, Vec2(3, 4));
  EXPECT_DOUBLE_EQ(s[1].rotation_rad, M_PI / 2.0);
  EXPECT_TRUE(s[1].large && !s[1].sweep);
  EXPECT_TRUE(!s[2].large && s[2].sweep);
  EXPECT_EQ(s[2].to, Vec2(5.5, 5));
}

TEST(SvgPath, DamageEndsTheSegmentsWhereItIs) {
  for (const auto& [d, good, rest] : {std::tuple("M0 0L1 x2 3", 1, "x2 3"),
                                      {"M0 0 1 1z2", 3, "2"},
                                      {"3 4", 0, "3 4"},
                                      {"L1 1", 0, "1 1"},
                                      {"M0 0a1 1 0 2 0 1 1", 1, "2 0 1 1"},
                                      {"M0 0R1 1", 1, "1 1"}}) {
    PathData data(d);
    int n = 0;
    while (data.next()) ++n;
    EXPECT_TRUE(data.damaged()) << d;
    EXPECT_EQ(n, good) << d;
    EXPECT_EQ(data.rest(), rest);
    EXPECT_FALSE(data.next());
  }
}

TEST(SvgTransform, EachFunctionMovesAPointAsItSays) {
  const Vec2 p(3, 5);
  for (const auto& [text, to] : {std::tuple("", Vec2(3, 5)),
                                 {"translate(2)", Vec2(5, 5)},
                                 {"translate(2,-1)", Vec2(5, 4)},
                                 {"scale(2)", Vec2(6, 10)},
                                 {"scale(2 -1)", Vec2(6, -5)},
                                 {"rotate(90)", Vec2(-5, 3)},
                                 {"rotate(180 3 0)", Vec2(3, -5)},
                                 {"skewX(45)", Vec2(8, 5)},
                                 {"skewY(45)", Vec2(3, 8)},
                                 {"matrix(1 2 3 4 5 6)", Vec2(23, 32)},
                                 {" scale (2),translate(1 1) ", Vec2(8, 12)}}) {
    const auto map = transform_of(text);
    ASSERT_TRUE(map) << text;
    EXPECT_NEAR((*map * p - to).norm(), 0.0, 1e-14) << text;
  }
  for (const char* text : {"translate", "translate()", "translate(1 2 3)", "matrix(1 2 3 4 5)", "skewX(1 2)",
                           "rotate(1 2)", "spin(1)", "scale(a)", ")scale(1", "matrix(1 2 3 4 5 6 7 8)"})
    EXPECT_FALSE(transform_of(text)) << text;
}

TEST(SvgTransform, ABoxFitsItsViewport) {
  const auto box = read_view_box("-1, 2 10 20");
  ASSERT_TRUE(box);
  // 10 x 20 units into 40 x 40: as large as it goes whole, as large as it fills all, or stretched.
  for (const auto& [aspect, corner, opposite] : {std::tuple("xMidYMid", Vec2(10, 0), Vec2(30, 40)),
                                                 {"xMinYMax meet", Vec2(0, 0), Vec2(20, 40)},
                                                 {"xMaxYMin slice", Vec2(0, 0), Vec2(40, 80)},
                                                 {"xMidYMax slice", Vec2(0, -40), Vec2(40, 40)},
                                                 {"none", Vec2(0, 0), Vec2(40, 40)}}) {
    const auto map = fitted(*box, {40, 40}, aspect);
    EXPECT_NEAR((map * Vec2(-1, 2) - corner).norm(), 0.0, 1e-13) << aspect;
    EXPECT_NEAR((map * Vec2(9, 22) - opposite).norm(), 0.0, 1e-13) << aspect;
  }
  EXPECT_FALSE(read_view_box("0 0 1"));
  EXPECT_FALSE(read_view_box("0 0 1 0"));
}

TEST(DxfBlocks, TheFirstReadingFindsThePartsWhereTheyStand) {
  const std::string text =
      "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n70\n4\n9\n$INSUNITS\n70\n5\n0\nENDSEC\n"
      "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nA\n10\n1\n20\n2\n0\nLINE\n10\n3\n0\nENDBLK\n"
      "0\nBLOCK\n2\nX\n70\n4\n0\nENDBLK\n0\nENDSEC\n"
      "0\nSECTION\n2\nENTITIES\n0\nARC\n40\n1\n0\nENDSEC\n0\nEOF\n";
  const auto lines_before = [&](const char* part) {
    return static_cast<std::size_t>(std::count(text.begin(), text.begin() + text.find(part), '\n'));
  };
  const auto contents = contents_of(text);
  ASSERT_TRUE(contents) << contents.error();
  EXPECT_EQ(contents->metres, 1e-2);
  ASSERT_EQ(contents->drawn.size(), 1u);
  EXPECT_EQ(contents->drawn[0].entities, "0\nARC\n40\n1\n");
  EXPECT_EQ(contents->drawn[0].line, lines_before("0\nARC"));
  const auto a = block_of({.block = "A"}, *contents);
  ASSERT_TRUE(a);
  EXPECT_EQ(a->part.entities, "0\nLINE\n10\n3\n");
  EXPECT_EQ(a->part.line, lines_before("0\nLINE"));
  EXPECT_EQ(a->base, Vec2(1, 2));
  EXPECT_FALSE(block_of({.block = "X"}, *contents));
  EXPECT_FALSE(block_of({.block = "B"}, *contents));
}

TEST(DxfBlocks, CopiesStandInRowsAndColumnsOfTheTurnedGrid) {
  const DxfInsert insert{.block = {},
                         .at = {10, 20},
                         .scale = {2, -1},
                         .angle_deg = 90.0,
                         .columns = 2,
                         .rows = 3,
                         .spacing = {5, 7}};
  const DxfBlock block{.part = {}, .base = {1, 1}};
  const auto place = place_of(insert, block, 2, 1, Eigen::Affine2d::Identity());
  EXPECT_NEAR((place * Vec2(1, 1) - Vec2(-4, 25)).norm(), 0.0, 1e-14);
  EXPECT_NEAR((place * Vec2(2, 1) - Vec2(-4, 27)).norm(), 0.0, 1e-14);
  EXPECT_NEAR((place * Vec2(1, 2) - Vec2(-3, 25)).norm(), 0.0, 1e-14);
}

TEST(Spline, WhatDoesNotFitTogetherIsRefused) {
  const Spline good{
      .degree = 2, .knots = {0, 0, 0, 1, 1, 1}, .control = {{0, 0}, {1, 1}, {2, 0}}, .weights = {}};
  EXPECT_FALSE(complaint_of(good));
  const auto spoilt = [&](auto&& spoil) {
    Spline s = good;
    spoil(s);
    return complaint_of(s).value_or("no complaint");
  };
  const std::string unfit = "a SPLINE's degree, knots and control points do not fit together";
  EXPECT_EQ(spoilt([](Spline& s) { s.degree = 0; }), unfit);
  EXPECT_EQ(spoilt([](Spline& s) { s.degree = 3; }), unfit);
  EXPECT_EQ(spoilt([](Spline& s) { s.knots.pop_back(); }), unfit);
  EXPECT_EQ(spoilt([](Spline& s) { s.knots[1] = 2; }), unfit);
  EXPECT_EQ(spoilt([](Spline& s) { s.weights = {1, 1}; }), unfit);
  EXPECT_EQ(spoilt([](Spline& s) { s.weights = {1, 0, 1}; }), "a SPLINE has a weight that is not positive");
}

/// A clamped spline with uneven knots, every other one with weights from 0.1 to 10.
Spline random_spline(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Spline s;
  s.degree = 1 + static_cast<int>(rng() % 10);
  const auto n = static_cast<std::size_t>(s.degree) + 1 + rng() % 8;
  s.knots.assign(n + s.degree + 1, 0.0);
  for (std::size_t i = s.degree + 1; i < s.knots.size(); ++i) s.knots[i] = i >= n ? 1.0 : uniform(rng);
  std::sort(s.knots.begin(), s.knots.end());
  for (std::size_t i = 0; i < n; ++i) s.control.emplace_back(100.0 * uniform(rng), 100.0 * uniform(rng));
  if (rng() % 2 == 0) {
    for (std::size_t i = 0; i < n; ++i) s.weights.push_back(std::pow(10.0, 2.0 * uniform(rng) - 1.0));
  }
  return s;
}

double distance_to(const std::vector<Vec2>& line, const Vec2& p) {
  double best = INFINITY;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vec2 way = line[i] - line[i - 1];
    const double t = std::clamp((p - line[i - 1]).dot(way) / std::max(1e-300, way.squaredNorm()), 0.0, 1.0);
    best = std::min(best, (line[i - 1] + t * way - p).norm());
  }
  return best;
}

TEST(Spline, ChordsStayWithinTheirError) {
  std::mt19937_64 rng(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Spline s = random_spline(rng);
    ASSERT_FALSE(complaint_of(s)) << trial;
    CurveWriter coarse(0.1, 1'000'000);
    CurveWriter fine(0.001, 1'000'000);
    draw(s, coarse);
    draw(s, fine);
    for (std::size_t i = 0; i < fine.points().size(); i += 7)
      ASSERT_LT(distance_to(coarse.points(), fine.points()[i]), 0.101) << trial << ", degree " << s.degree;
  }
}

TEST(Numbers, EndWhereTheyEnd) {
  for (const auto& [text, value, rest] : {std::tuple("1.5mm", 1.5, "mm"),
                                          {" ,\t\n-2e1,3", -20.0, ",3"},
                                          {"+.5.5", 0.5, ".5"},
                                          {"1-2", 1.0, "-2"},
                                          {"3e", 3.0, "e"}}) {
    std::string_view left = text;
    const auto number = take_number(left);
    ASSERT_TRUE(number) << text;
    EXPECT_EQ(*number, value) << text;
    EXPECT_EQ(left, rest) << text;
  }
  for (const char* none : {"", "x1", "nan", "inf", "-", "1e999"}) {
    std::string_view left = none;
    EXPECT_FALSE(take_number(left)) << none;
  }
}

TEST(SvgLengths, UnitsAreTheirMetres) {
  for (const auto& [text, metres] : {std::pair("96", 25.4e-3),
                                     {"96px", 25.4e-3},
                                     {"1in", 25.4e-3},
                                     {"72pt", 25.4e-3},
                                     {"6pc ", 25.4e-3},
                                     {"2mm", 2e-3},
                                     {"2cm", 2e-2},
                                     {"2m", 2.0}}) {
    ASSERT_TRUE(svg_length_m(text)) << text;
    EXPECT_NEAR(*svg_length_m(text), metres, 1e-15) << text;
  }
  for (const char* none : {"2em", "2%", "mm", "2 mm x"}) EXPECT_FALSE(svg_length_m(none)) << none;
  EXPECT_FALSE(svg_length_m(nullptr));
  // Per cents are of the width, of the height, or of the diagonal over sqrt 2.
  const auto d = read_svg(
      "<svg stroke='black' fill='none' width='80mm' height='60mm' viewBox='0 0 80 60'><line x1='50%' "
      "y1='50%' x2='60%' y2='60%'/>"
      "<circle cx='25%' cy='25%' r='10%'/></svg>");
  ASSERT_TRUE(d) << d.error();
  EXPECT_NEAR((d->contours[0].points_m[0] - 1e-3 * Vec2(40, -30)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((d->contours[0].points_m[1] - 1e-3 * Vec2(48, -36)).norm(), 0.0, 1e-15);
  EXPECT_NEAR(geometry::bounding_box(d->contours[1].points_m).size().x(),
              2e-3 * 0.1 * std::hypot(80, 60) / std::sqrt(2.0), 1e-12);
}

TEST(Joining, EndsMeetWithinTheToleranceAndNotBeyond) {
  const auto lines = [](double gap, double last_gap) {
    return std::vector<geometry::Polyline>{
        {{{0, 0}, {1, 0}}, false}, {{{1, 1}, {1, gap}}, false}, {{{1, 1}, {0, last_gap}}, false}};
  };
  const auto ring = joined(lines(0.99e-8, 0.99e-8), 1e-8).lines;
  ASSERT_EQ(ring.size(), 1u);
  EXPECT_TRUE(ring[0].closed);
  EXPECT_EQ(ring[0].size(), 3u);
  const auto open = joined(lines(0.99e-8, 1.01e-8), 1e-8).lines;
  ASSERT_EQ(open.size(), 1u);
  EXPECT_FALSE(open[0].closed);
  EXPECT_EQ(open[0].size(), 4u);
  EXPECT_EQ(joined(lines(1.01e-8, 1.01e-8), 1e-8).lines.size(), 2u);
  // There and back is no ring, and what is closed stays by itself.
  const std::vector<geometry::Polyline> two{
      {{{0, 0}, {1, 0}}, false}, {{{1, 0}, {0, 0}}, false}, {{{0, 0}, {1, 0}, {1, 1}}, true}};
  const auto apart = joined(two, 1e-8).lines;
  ASSERT_EQ(apart.size(), 2u);
  EXPECT_FALSE(apart[0].closed);
  EXPECT_TRUE(apart[1].closed);
}

TEST(DrawnLines, TakeAsManyPointsAsTheirLimit) {
  VectorLimits limits;
  limits.max_points = 4;
  const std::string two = "<line x2='1'/><line y1='5' x2='1' y2='5'/>";
  EXPECT_TRUE(read_svg("<svg stroke='black'>" + two + "</svg>", limits));
  const auto more = read_svg("<svg stroke='black'>" + two + "<line y1='9' x2='1' y2='9'/></svg>", limits);
  ASSERT_FALSE(more);
  EXPECT_EQ(more.error(), "the drawing has more than 4 points");
  limits.max_bytes = 20;
  EXPECT_NE(read_svg("<svg><line x2='1'/></svg>", limits).error().find("larger than"), std::string::npos);
}

TEST(DrawnLines, WhatHasNoLengthIsCounted) {
  const auto notes = [](const std::string& body) {
    const auto out = read_svg("<svg stroke='black' fill='none'>" + body + "</svg>");
    EXPECT_TRUE(out) << out.error();
    std::string all;
    for (const std::string& note : out->notes) all += note + "; ";
    return all;
  };
  const std::string line = "<line x2='9'/>";
  EXPECT_EQ(notes(line).find("without any length"), std::string::npos);
  EXPECT_EQ(notes(line + "<g display='none'><path d='M5 5h0'/></g>").find("without any length"),
            std::string::npos);
  EXPECT_NE(notes(line + "<path d='M5 5h0M6 6L6 6z'/>").find("left out: 2 without any length"),
            std::string::npos)
      << notes(line + "<path d='M5 5h0M6 6L6 6z'/>");
}

}  // namespace
}  // namespace telekerf::vision
