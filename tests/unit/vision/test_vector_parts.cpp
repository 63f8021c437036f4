// SPDX-License-Identifier: Apache-2.0
// The parts that the readers of vector files are made of, each on its own.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "common/vision/svg_path.h"
#include "common/vision/svg_transform.h"

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

}  // namespace
}  // namespace telekerf::vision
