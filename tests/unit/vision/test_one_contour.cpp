// SPDX-License-Identifier: Apache-2.0
// One contour is one contour: joined, closed, and cut once, whatever the order of its lines in the file.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <random>
#include <string>

#include "common/vision/vector/doubles.h"
#include "common/vision/vector/dxf/document.h"
#include "common/vision/vector/joining.h"
#include "common/vision/vector/svg/document.h"

namespace telekerf::vision {
namespace {

using geometry::length_m;
using geometry::Polyline;

struct Tally {
  std::size_t closed = 0;
  std::size_t open = 0;
  double length = 0.0;
  bool operator==(const Tally&) const = default;
};

/// Lengths rounded to a nanometre, so that sums in another order are equal.
Tally tally(const std::vector<Polyline>& lines) {
  Tally out;
  for (const auto& line : lines) {
    (line.closed ? out.closed : out.open) += 1;
    out.length += length_m(line);
  }
  out.length = std::round(1e9 * out.length) / 1e9;
  return out;
}

Tally in_any_order(std::vector<Polyline> lines, double tolerance) {
  const Tally first = tally(joined(lines, tolerance).lines);
  std::mt19937_64 rng(1);
  for (int i = 0; i < 50; ++i) {
    std::shuffle(lines.begin(), lines.end(), rng);
    for (auto& line : lines) {
      if (rng() % 2 == 0) std::reverse(line.points_m.begin(), line.points_m.end());
    }
    EXPECT_EQ(tally(joined(lines, tolerance).lines), first) << "order " << i;
  }
  return first;
}

Polyline line(const Vec2& a, const Vec2& b) { return {{a, b}, false}; }

TEST(OneContour, WhatClosesGoesFirstAtBranches) {
  const std::vector<Polyline> ring{line({0, 0}, {1, 0}), line({1, 0}, {2, 0}), line({2, 0}, {2, 1}),
                                   line({2, 1}, {1, 1}), line({1, 1}, {0, 1}), line({0, 1}, {0, 0})};
  auto divided = ring;
  divided.push_back(line({1, 0}, {1, 1}));
  EXPECT_EQ(in_any_order(divided, 1e-5), (Tally{1, 1, 7.0}));
  auto tail = ring;
  tail.push_back(line({2, 0}, {5, 0}));  // goes straight on from a side
  EXPECT_EQ(in_any_order(tail, 1e-5), (Tally{1, 1, 9.0}));
  auto bridge = tail;  // two rings and a bridge
  for (Polyline other : ring) {
    for (Vec2& p : other.points_m) p.x() += 5.0;
    bridge.push_back(other);
  }
  EXPECT_EQ(in_any_order(bridge, 1e-5), (Tally{2, 1, 15.0}));
  auto touching = ring;  // two rings that touch at a corner
  for (Polyline other : ring) {
    for (Vec2& p : other.points_m) p += Vec2(2.0, 1.0);
    touching.push_back(other);
  }
  EXPECT_EQ(in_any_order(touching, 1e-5), (Tally{2, 0, 12.0}));
  // A cross of four lines is two.
  EXPECT_EQ(
      in_any_order({line({0, 0}, {1, 0}), line({0, 0}, {-1, 0}), line({0, 0}, {0, 1}), line({0, 0}, {0, -1})},
                   1e-5),
      (Tally{0, 2, 4.0}));
}

TEST(OneContour, GapsWithinTheToleranceAreNone) {
  for (const double gap : {0.0, 0.5e-5, 0.9e-5}) {
    const auto out = joined(
        {line({0, 0}, {1, 0}), line({1, gap}, {1, 1}), line({1 - gap, 1}, {0, 1}), line({0, 1}, {0, gap})},
        1e-5);
    ASSERT_EQ(out.lines.size(), 1u) << gap;
    EXPECT_TRUE(out.lines[0].closed);
    EXPECT_EQ(out.lines[0].size(), 4u);
    EXPECT_EQ(out.ends, 8u);
  }
}

TEST(OneContour, CurvesOfLinesShorterThanTheToleranceStayCurves) {
  const double tolerance = 1e-5;
  for (const double side : {1e-5, 0.8e-5, 3e-6, 1.5e-5}) {
    std::vector<Polyline> circle;
    const int n = static_cast<int>(2.0 * M_PI * 1e-3 / side);
    const auto at = [&](int i) {
      return Vec2(1e-3 * std::cos(2.0 * M_PI * i / n), 1e-3 * std::sin(2.0 * M_PI * i / n));
    };
    for (int i = 0; i < n; ++i) circle.push_back(line(at(i), at((i + 1) % n)));
    const auto out = joined(circle, tolerance);
    ASSERT_EQ(out.lines.size(), 1u) << side;
    EXPECT_TRUE(out.lines[0].closed) << side;
    EXPECT_EQ(out.lines[0].size(), circle.size()) << side;
    EXPECT_NEAR(geometry::length_m(out.lines[0]), 2.0 * M_PI * 1e-3, 1e-7) << side;
  }
  // A gap bridged by a sliver is bridged once.
  const auto sliver = joined(
      {line({0, 0}, {1, 0}), line({1 + 1e-6, 0}, {1 + 4e-6, 0}), line({1 + 5e-6, 0}, {2, 0})}, tolerance);
  ASSERT_EQ(sliver.lines.size(), 1u);
  EXPECT_FALSE(sliver.lines[0].closed);
  EXPECT_EQ(sliver.lines[0].size(), 4u);
  // Lines side by side do not hang on each other for more than twice the tolerance.
  std::vector<Polyline> hatch;
  for (int i = 0; i < 20; ++i) hatch.push_back(line({i * 0.9e-5, 0}, {i * 0.9e-5, 1}));
  for (const Polyline& l : joined(hatch, tolerance).lines) {
    for (const Vec2& p : l.points_m)
      EXPECT_LE(std::abs(p.x() - 0.9e-5 * std::round(p.x() / 0.9e-5)), 1e-5 + 1e-12);
  }
}

TEST(OneContour, LinesOnEachOtherAreCutOnce) {
  const Polyline square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, true};
  Polyline turned{{{1, 1}, {1, 0}, {0, 0}, {0, 1}}, true};
  const auto cut = [](std::vector<Polyline> lines) {
    return tally(without_doubles(std::move(lines), 2e-6).lines);
  };
  EXPECT_EQ(cut({square, turned}), (Tally{1, 0, 4.0}));
  EXPECT_EQ(cut({line({0.2, 0}, {0.7, 1e-6}), square}), (Tally{1, 0, 4.0}));
  EXPECT_EQ(cut({line({0, 0}, {2, 0}), line({3, 0}, {1, 0})}), (Tally{0, 2, 3.0}));
  EXPECT_EQ(cut({square, line({0.5, 0}, {2, 0})}), (Tally{1, 1, 5.0}));
  // A side that two squares share.
  EXPECT_EQ(cut({square, {{{1, 0}, {2, 0}, {2, 1}, {1, 1}}, true}}), (Tally{1, 1, 7.0}));
  // There and back.
  EXPECT_EQ(cut({{{{0, 0}, {1, 0}}, true}}), (Tally{0, 1, 1.0}));
  EXPECT_EQ(cut({{{{0, 0}, {1, 0}, {0, 0}}, false}}), (Tally{0, 1, 1.0}));
  // Near each other, crossing, or meeting at a small angle is not the same.
  EXPECT_EQ(cut({line({0, 0}, {1, 0}), line({0, 1e-5}, {1, 1e-5})}), (Tally{0, 2, 2.0}));
  EXPECT_EQ(cut({line({0, 0}, {1, 0}), line({0, 0}, {1, 0.001})}).open, 2u);
  EXPECT_EQ(cut({line({0, 0}, {1, 0}), line({0.5, -1}, {0.5, 1})}), (Tally{0, 2, 3.0}));
}

TEST(OneContour, CirclesThatTouchStayWhole) {
  std::string body;
  for (const auto& [x, r] : {std::pair(0.0, 10.0), {20.0, 10.0}, {5.0, 5.0}, {30.5, 0.5}})
    body += fmt::format("<circle cx='{}' cy='0' r='{}' fill='none' stroke='red'/>", x, r);
  const auto d = read_svg("<svg width='99mm' height='99mm' viewBox='0 0 99 99'>" + body + "</svg>");
  ASSERT_TRUE(d) << d.error();
  EXPECT_EQ(d->contours.size(), 4u);
  EXPECT_TRUE(d->left_out.empty());
  // Drawn as two arcs over a circle it is one all the same.
  const auto twice = read_svg(
      "<svg width='99mm' height='99mm' viewBox='0 0 99 99' fill='none' stroke='red'><circle r='9'/>"
      "<path d='M9 0A9 9 0 0 1 0 9'/><path d='M-9 0A9 9 0 1 0 9 0'/></svg>");
  ASSERT_TRUE(twice);
  EXPECT_EQ(twice->contours.size(), 1u);
  EXPECT_EQ(twice->left_out.size(), 2u);
}

TEST(OneContour, TenThousandCirclesTakeTimeInProportion) {
  const auto seconds = [](int side) {
    std::string body;
    for (int i = 0; i < side * side; ++i)
      body += fmt::format("<circle cx='{}' cy='{}' r='0.4' fill='none' stroke='red'/>", i % side, i / side);
    const std::clock_t before = std::clock();
    const auto d = read_svg("<svg width='100mm' height='100mm' viewBox='0 0 100 100'>" + body + "</svg>");
    EXPECT_TRUE(d && d->contours.size() == static_cast<std::size_t>(side * side));
    return static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  };
  seconds(10);
  const double few = seconds(50);
  EXPECT_LT(seconds(100), 8.0 * few);
}

std::string dxf_of(const std::string& tables, const std::string& entities, const std::string& header = "") {
  return "0\nSECTION\n2\nHEADER\n" + header + "0\nENDSEC\n0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n" +
         tables + "0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n";
}

TEST(DxfLayers, WhatIsNotShownOrNotPlottedIsLeftOutAndNamed) {
  const std::string seen = "0\nCIRCLE\n8\n0\n10\n0\n20\n0\n40\n3\n";
  for (const auto& [layer, name] : {std::pair("70\n1\n62\n7\n", "frozen"),
                                    {"70\n0\n62\n-7\n", "off"},
                                    {"70\n0\n62\n7\n290\n0\n", "not plotted"}}) {
    const std::string table = fmt::format("0\nLAYER\n2\nHidden\n{}", layer);
    const auto d = read_dxf(dxf_of(table, seen + "0\nLINE\n8\nHIDDEN\n10\n0\n20\n0\n11\n9\n21\n9\n"));
    ASSERT_TRUE(d) << d.error();
    EXPECT_EQ(d->contours.size(), 1u);
    ASSERT_EQ(d->left_out.size(), 1u);
    EXPECT_NE(d->left_out[0].why.find(name), std::string::npos) << d->left_out[0].why;
  }
  const auto points = read_dxf(dxf_of("", seen + "0\nLINE\n8\nDefpoints\n10\n0\n20\n0\n11\n9\n21\n9\n"));
  EXPECT_EQ(points->contours.size(), 1u);
  const auto chosen = read_dxf(dxf_of("", seen + "0\nLINE\n8\nA\n62\n1\n10\n0\n20\n0\n11\n90\n21\n90\n"), {},
                               {.colours = {"1"}});
  ASSERT_TRUE(chosen);
  EXPECT_FALSE(chosen->contours.at(0).closed);
}

TEST(DxfCurves, AnyLineEndsAndMarksAreRead) {
  const std::string plain = dxf_of("", "0\nLINE\n10\n0\n20\n0\n11\n9\n21\n0\n", "9\n$MEASUREMENT\n70\n0\n");
  for (const std::string end : {"\n", "\r\n", "\r", "\r\r\n"}) {
    std::string text = "\xEF\xBB\xBF";
    for (const char c : plain) c == '\n' ? text += end : text += c;
    const auto d = read_dxf(text);
    ASSERT_TRUE(d) << d.error();
    EXPECT_NEAR(length_m(d->contours.at(0)), 9 * 25.4e-3, 1e-12);  // imperial, and no unit
    EXPECT_NE(d->size_from.find("inch"), std::string::npos);
  }
}

TEST(DxfCurves, ASplineOfFitPointsIsSmooth) {
  std::string spline = "0\nSPLINE\n70\n8\n71\n3\n74\n5\n";
  for (const auto& [x, y] : {std::pair(0, 0), {10, 8}, {20, 0}, {30, -8}, {40, 0}})
    spline += fmt::format("11\n{}\n21\n{}\n", x, y);
  const auto d = read_dxf(dxf_of("", spline));
  ASSERT_TRUE(d) << d.error();
  EXPECT_NEAR(1e3 * length_m(d->contours.at(0)), 52.614, 0.05);
  // All is alike forwards and backwards, and a circle's points give nearly the circle.
  std::string ring = "0\nSPLINE\n70\n11\n71\n3\n";
  for (int i = 0; i < 16; ++i)
    ring += fmt::format("11\n{:.9f}\n21\n{:.9f}\n", 10 * std::cos(i * M_PI / 8), 10 * std::sin(i * M_PI / 8));
  const auto closed = read_dxf(dxf_of("", ring));
  ASSERT_TRUE(closed) << closed.error();
  ASSERT_TRUE(closed->contours.at(0).closed);
  for (const Vec2& p : closed->contours[0].points_m) EXPECT_NEAR(p.norm(), 10e-3, 3e-6);
}

TEST(DxfCurves, FlatPolylinesOfThreeDimensionsAreDrawn) {
  const auto polyline = [](int flags, double z) {
    return fmt::format(
        "0\nPOLYLINE\n70\n{}"
        "\n0\nVERTEX\n10\n0\n20\n0\n30\n5\n70\n32\n0\nVERTEX\n10\n9\n20\n0\n30\n5\n70\n32\n"
        "0\nVERTEX\n10\n4\n20\n4\n70\n16\n30\n5\n0\nVERTEX\n10\n9\n20\n9\n30\n{}\n70\n32\n0\nSEQEND\n",
        flags, z);
  };
  const auto flat = read_dxf(dxf_of("", polyline(9, 5)));
  ASSERT_TRUE(flat) << flat.error();
  EXPECT_EQ(flat->contours.at(0).size(), 3u);
  EXPECT_FALSE(read_dxf(dxf_of("", polyline(9, 7))));
  EXPECT_EQ(read_dxf(dxf_of("", polyline(5, 5)))->contours.at(0).size(), 3u);  // fitted by a spline
}

}  // namespace
}  // namespace telekerf::vision
