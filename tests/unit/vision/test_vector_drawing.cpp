// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "common/vision/vector/dxf/document.h"
#include "common/vision/vector/svg/document.h"

namespace telekerf::vision {
namespace {

using geometry::bounding_box;
using geometry::length_m;
using geometry::Polyline;

VectorDrawing svg(const std::string& body,
                  const std::string& head = R"svg(width="100mm" height="100mm" viewBox="0 0 100 100")svg") {
  const auto out = read_svg("<svg xmlns=\"http://www.w3.org/2000/svg\" stroke=\"black\" fill=\"none\" " +
                            head + ">" + body + "</svg>");
  EXPECT_TRUE(out) << out.error();
  return out.value_or(VectorDrawing{});
}

std::string entities(const std::string& text, const std::string& header = "") {
  return header + "0\nSECTION\n2\nENTITIES\n" + text + "0\nENDSEC\n0\nEOF\n";
}

VectorDrawing dxf(const std::string& text, const std::string& header = "") {
  const auto out = read_dxf(entities(text, header));
  EXPECT_TRUE(out) << out.error();
  return out.value_or(VectorDrawing{});
}

TEST(Svg, ShapesHaveTheirTrueSize) {
  const auto d = svg(R"svg(<circle cx="50" cy="50" r="10"/><rect x="1" y="2" width="30" height="20"/>
                        <line x1="0" y1="0" x2="3" y2="4"/><ellipse cx="0" cy="0" rx="4" ry="2"/>)svg");
  ASSERT_EQ(d.contours.size(), 4u);
  EXPECT_TRUE(d.contours[0].closed);
  const auto circle = bounding_box(d.contours[0].points_m);
  EXPECT_NEAR(circle.size().x(), 20e-3, 1e-12);
  EXPECT_NEAR(circle.size().y(), 20e-3, 1e-12);
  EXPECT_NEAR(circle.centre().y(), -50e-3, 1e-12);  // y upwards
  EXPECT_NEAR(length_m(d.contours[0]), 2e-2 * M_PI, 1e-6);
  EXPECT_NEAR(length_m(d.contours[1]), 100e-3, 1e-12);
  EXPECT_NEAR(length_m(d.contours[2]), 5e-3, 1e-12);
  EXPECT_FALSE(d.contours[2].closed);
}

TEST(Svg, UnitsOfWidthSetTheScale) {
  const std::string line = R"svg(<line x1="0" y1="0" x2="96" y2="0"/>)svg";
  const auto length = [&](const std::string& head) { return length_m(svg(line, head).contours.at(0)); };
  EXPECT_NEAR(length(""), 25.4e-3, 1e-12);
  EXPECT_NEAR(length(R"svg(width="96" height="96")svg"), 25.4e-3, 1e-12);
  EXPECT_NEAR(length(R"svg(width="2in" height="2in" viewBox="0 0 96 96")svg"), 50.8e-3, 1e-12);
  EXPECT_NEAR(length(R"svg(width="12cm" height="12cm" viewBox="0 0 960 960")svg"), 12e-3, 1e-12);
  EXPECT_NEAR(length(R"svg(width="72pt" viewBox="0 0 96 96")svg"), 25.4e-3, 1e-12);
  EXPECT_NEAR(length(R"svg(width="100%" viewBox="0 0 960 960")svg"), 25.4e-3, 1e-12);
}

TEST(Svg, PathCommandsAbsoluteRelativeAndRepeated) {
  const auto d = svg(R"svg(<path d="M10,10L20-10H30V5l1e0.5-2 1.5h-1v+1z m5 5 10 0 0 10z"/>)svg");
  ASSERT_EQ(d.contours.size(), 2u);
  EXPECT_EQ(d.contours[0].size(), 8u);
  EXPECT_NEAR(d.contours[0].points_m[1].y(), 10e-3, 1e-15);
  EXPECT_TRUE(d.contours[1].closed);
  EXPECT_NEAR(d.contours[1].points_m[0].x(), 15e-3, 1e-15);
  EXPECT_NEAR(geometry::signed_area_m2(d.contours[1]), -50e-6, 1e-15);
}

TEST(Svg, AClosedPathDoesNotRepeatItsStartForRounding) {
  const auto d = svg(R"svg(<path d="M0.1 0l0.1 0 0.1 0.2-0.2-0.2z"/>)svg");  // 0.1 + 0.1 + 0.1 - 0.2 > 0.1
  EXPECT_EQ(d.contours.at(0).size(), 3u);
}

TEST(Svg, CurvesStayWithinTheChordError) {
  // A half circle as an arc; the same flags glued together as optimisers write them.
  for (const char* arc : {"M0 0A5 5 0 0 1 10 0", "M0 0a5 5 0 0110 0", "M0 0a5,5,0,1,1,10,0"}) {
    const auto d = svg(std::string("<path d=\"") + arc + "\"/>");
    ASSERT_EQ(d.contours.size(), 1u);
    for (const Vec2& p : d.contours[0].points_m) EXPECT_NEAR((p - Vec2(5e-3, 0)).norm(), 5e-3, 1e-12);
    EXPECT_NEAR(length_m(d.contours[0]), M_PI * 5e-3, 1e-6);
  }
  // A quadratic is the parabola it says, a smooth cubic continues its tangent.
  const auto q = svg(R"svg(<path d="M0 0Q5 10 10 0T20 0"/>)svg");
  for (const Vec2& p : q.contours[0].points_m) {
    const double x = 1e3 * p.x();
    const double u = x <= 10.0 ? x / 10.0 : (x - 10.0) / 10.0;
    EXPECT_NEAR(1e3 * p.y(), (x <= 10.0 ? -1.0 : 1.0) * 20.0 * u * (1.0 - u), 1e-9);
  }
  const auto s = svg(R"svg(<path d="M0 0C0 5 5 10 10 10S20 15 20 20"/>)svg");
  const Polyline& line = s.contours[0];
  for (std::size_t i = 2; i < line.size(); ++i) {
    const Vec2 a = line.points_m[i - 1] - line.points_m[i - 2];
    const Vec2 b = line.points_m[i] - line.points_m[i - 1];
    EXPECT_LT(std::abs(std::atan2(geometry::cross(a, b), a.dot(b))), 0.05);
  }
}

TEST(Svg, TransformsNest) {
  const auto d = svg(R"svg(<g transform="translate(10 20)"><g transform="rotate(90) scale(2)">
      <line x1="0" y1="0" x2="3" y2="0" transform="matrix(1 0 0 1 1 0)"/></g></g>)svg");
  const auto& p = d.contours.at(0).points_m;
  EXPECT_NEAR((p[0] - 1e-3 * Vec2(10, -22)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((p[1] - 1e-3 * Vec2(10, -28)).norm(), 0.0, 1e-15);
}

TEST(Svg, WhatIsNotDrawnIsLeftOutAndTouchingLinesJoin) {
  const auto d = svg(
      R"svg(<defs><circle r="5"/></defs><circle r="1" display="none"/><circle r="1" style="display : none"/>
      <line x1="0" y1="0" x2="1" y2="0"/><line x1="1" y1="1" x2="1" y2="0"/><line x1="1" y1="1" x2="0" y2="0"/>)svg");
  ASSERT_EQ(d.contours.size(), 1u);
  EXPECT_TRUE(d.contours[0].closed);
  EXPECT_EQ(d.contours[0].size(), 3u);
}

std::string svg_error(const std::string& text) {
  const auto out = read_svg(text);
  return out ? std::string("no error") : out.error();
}

TEST(Svg, UseDrawsWhatIsDefinedElsewhere) {
  const auto d = svg(R"svg(<defs><g id="arm"><line id="bar" x1="0" y1="0" x2="3" y2="0"/></g></defs>
      <g id="pair"><use href="#arm" x="10" y="20"/><use xlink:href="#bar" transform="rotate(90)" x="1"/></g>
      <use href="#pair" transform="translate(50 0) scale(2)"/>)svg");
  const auto ends = [&](std::size_t i, const Vec2& from, const Vec2& to) {
    const auto& p = d.contours.at(i).points_m;
    EXPECT_NEAR((p.front() - 1e-3 * from).norm() + (p.back() - 1e-3 * to).norm(), 0.0, 1e-15) << i;
  };
  ASSERT_EQ(d.contours.size(), 4u);
  ends(0, {10, -20}, {13, -20});
  ends(1, {0, -1}, {0, -4});
  ends(2, {70, -40}, {76, -40});
  ends(3, {50, -2}, {50, -8});
  EXPECT_TRUE(d.unsupported.empty());
}

TEST(Svg, SymbolsAndNestedDrawingsFitTheirViewports) {
  // 10 x 10 units into 40 x 20: scale 2, in the middle of the width; then at its left; then stretched.
  for (const auto& [aspect, x, width] : {std::tuple("", 10.0, 20.0),
                                         {"preserveAspectRatio='xMinYMid'", 0.0, 20.0},
                                         {"preserveAspectRatio='xMidYMid slice'", 0.0, 40.0},
                                         {"preserveAspectRatio='none'", 0.0, 40.0}}) {
    const std::string head = fmt::format(" viewBox='5 5 10 10' {}>", aspect);
    const std::string body = "<line x1='5' y1='10' x2='15' y2='10'/>";
    const auto used =
        svg(fmt::format("<symbol id='s'{}{}</symbol><use href='#s' width='40' height='20'/>", head, body));
    const auto nested = svg(fmt::format("<svg width='40%' height='20'{}{}</svg>", head, body));
    for (const auto& d : {used, nested}) {
      ASSERT_EQ(d.contours.size(), 1u);
      const auto& p = d.contours[0].points_m;
      EXPECT_NEAR(p.front().x(), x * 1e-3, 1e-15) << aspect;
      EXPECT_NEAR(p.back().x() - p.front().x(), width * 1e-3, 1e-15) << aspect;
      EXPECT_NEAR(p.front().y(), -10e-3, 1e-15) << aspect;
    }
  }
}

TEST(Svg, WhatCannotBeFollowedIsNamed) {
  const auto d = svg(R"svg(<text>a</text><text>b</text><image href="p.png"/><line x2="1" clip-path="url(#c)"/>
      <defs><text>unseen</text></defs><sodipodi:namedview/><metadata/>)svg");
  EXPECT_EQ(d.unsupported.sentence(), "1 image, 2 text");
  EXPECT_NE(svg_error("<svg><text>a</text></svg>").find("1 text"), std::string::npos);
  EXPECT_NE(svg_error("<svg><use href='#no'/><line x2='1'/></svg>").find("#no"), std::string::npos);
  EXPECT_NE(svg_error("<svg><use href='other.svg#a'/><line x2='1'/></svg>").find("same file"),
            std::string::npos);
  EXPECT_NE(svg_error("<svg><g id='a'><line x2='1'/><use href='#a'/></g></svg>").find("within itself"),
            std::string::npos);
  EXPECT_NE(
      svg_error("<svg><g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g></svg>").find("itself"),
      std::string::npos);
  EXPECT_NE(svg_error("<svg><rect width='3em' height='1'/></svg>").find("3em"), std::string::npos);
  // Ten times ten times ten ...: many elements from few bytes, whether they draw anything or not.
  for (const char* leaf : {"<line x2='1'/>", "<g/>"}) {
    std::string bomb = fmt::format("<svg><defs><g id='a0'>{}</g>", leaf);
    for (int i = 1; i < 12; ++i) {
      bomb += fmt::format("<g id='a{}'>", i);
      for (int k = 0; k < 10; ++k) bomb += fmt::format("<use href='#a{}'/>", i - 1);
      bomb += "</g>";
    }
    VectorLimits few;
    few.max_points = 20000;
    const auto out = read_svg(bomb + "</defs><use href='#a11'/></svg>", few);
    ASSERT_FALSE(out);
    EXPECT_NE(out.error().find("more than 20000"), std::string::npos) << out.error();
  }
}

TEST(Svg, DamageIsAnErrorThatSaysWhere) {
  const auto error = [](const std::string& text) {
    const auto out = read_svg(text);
    return out ? std::string("no error") : out.error();
  };
  EXPECT_NE(error("").find("not an SVG"), std::string::npos);
  EXPECT_NE(error("<html/>").find("root element"), std::string::npos);
  EXPECT_NE(error("<svg></svg>").find("draws no line"), std::string::npos);
  EXPECT_NE(error("<svg><path d='M 0 0 L 1 x'/></svg>").find("near"), std::string::npos);
  EXPECT_NE(error("<svg><path d='L 0 0'/></svg>").find("near"), std::string::npos);
  EXPECT_NE(error("<svg><path d='M 0 0 L 1e999 2'/></svg>").find("near"), std::string::npos);
  EXPECT_NE(error("<svg><g transform='spin(3)'><line x2='1'/></g></svg>").find("transform"),
            std::string::npos);
  EXPECT_NE(error("<svg><polyline points='1 2 3'/></svg>").find("odd"), std::string::npos);
  EXPECT_NE(
      error("<svg><polyline points='0,0 5,5 x 9,9'/></svg>").find("near \"0,0 5,5 x 9,9\" (character 9"),
      std::string::npos)
      << error("<svg><polyline points='0,0 5,5 x 9,9'/></svg>");
  EXPECT_NE(error("<svg viewBox='0 0 0 0'><line x2='1'/></svg>").find("viewBox"), std::string::npos);
  for (const std::string width : {"10,5mm", "-5mm", "0", "3 apples", "nan"}) {
    const std::string svg = "<svg width='" + width + "' viewBox='0 0 9 9'><line x2='1'/></svg>";
    EXPECT_NE(error(svg).find(width), std::string::npos) << svg;
  }
  for (const std::string width : {"100%", "auto", "10.5mm", " 7 "})
    EXPECT_EQ(error("<svg stroke='red' width='" + width + "' viewBox='0 0 9 9'><line x2='1'/></svg>"),
              "no error")
        << width;
  std::string deep = "<svg>";
  for (int i = 0; i < 300; ++i) deep += "<g>";
  EXPECT_NE(error(deep).find("no error"), 0u);
  // A curve that asks for more points than are allowed is refused, not drawn.
  VectorLimits few;
  few.max_points = 100;
  EXPECT_FALSE(read_svg("<svg><circle r='1000'/></svg>", few));
}

TEST(Dxf, EntitiesHaveTheirTrueSize) {
  const auto d =
      dxf("0\nCIRCLE\n10\n5\n20\n5\n40\n10\n"
          "0\nARC\n10\n100\n20\n0\n40\n5\n50\n0\n51\n90\n"
          "0\nLINE\n10\n200\n20\n0\n11\n203\n21\n4\n");
  ASSERT_EQ(d.contours.size(), 3u);
  EXPECT_TRUE(d.contours[0].closed);
  EXPECT_NEAR(bounding_box(d.contours[0].points_m).size().x(), 20e-3, 1e-12);
  EXPECT_NEAR(length_m(d.contours[1]), 2.5e-3 * M_PI, 1e-6);
  EXPECT_NEAR((d.contours[1].points_m.back() - 1e-3 * Vec2(100, 5)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(length_m(d.contours[2]), 5e-3, 1e-12);
}

TEST(Dxf, BulgesAreArcs) {
  const auto d = dxf("0\nLWPOLYLINE\n90\n2\n70\n1\n10\n-4\n20\n0\n42\n1\n10\n4\n20\n0\n42\n1\n");
  ASSERT_EQ(d.contours.size(), 1u);
  EXPECT_TRUE(d.contours[0].closed);
  for (const Vec2& p : d.contours[0].points_m) EXPECT_NEAR(p.norm(), 4e-3, 1e-12);
  EXPECT_GT(geometry::signed_area_m2(d.contours[0]), 0.0);  // a positive bulge turns left
  const auto old =
      dxf("0\nPOLYLINE\n70\n1\n0\nVERTEX\n10\n0\n20\n0\n0\nVERTEX\n10\n2\n20\n0\n42\n0.41421356237309503\n"
          "0\nVERTEX\n10\n2\n20\n2\n0\nSEQEND\n");
  ASSERT_EQ(old.contours.size(), 1u);
  EXPECT_NEAR(length_m(old.contours[0]), 1e-3 * (2 + std::sqrt(2.0) * M_PI / 2 + std::sqrt(8.0)), 1e-6);
}

TEST(Dxf, SplinesAreTheirCurves) {
  // A rational quadratic quarter circle: three control points, middle weight 1/sqrt 2.
  const auto d =
      dxf("0\nSPLINE\n70\n4\n71\n2\n40\n0\n40\n0\n40\n0\n40\n1\n40\n1\n40\n1\n41\n1\n41\n0."
          "70710678118654752\n41\n1\n"
          "10\n10\n20\n0\n10\n10\n20\n10\n10\n0\n20\n10\n");
  ASSERT_EQ(d.contours.size(), 1u);
  for (const Vec2& p : d.contours[0].points_m) EXPECT_NEAR(p.norm(), 10e-3, 1e-12);
  EXPECT_NEAR(length_m(d.contours[0]), 5e-3 * M_PI, 1e-6);
}

TEST(Dxf, UnitsAndExtrusion) {
  const std::string header = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n1\n0\nENDSEC\n";
  EXPECT_NEAR(length_m(dxf("0\nLINE\n10\n0\n20\n0\n11\n2\n21\n0\n", header).contours.at(0)), 50.8e-3, 1e-12);
  const auto mirrored = dxf("0\nCIRCLE\n10\n5\n20\n0\n40\n1\n230\n-1\n");
  EXPECT_NEAR(bounding_box(mirrored.contours.at(0).points_m).centre().x(), -5e-3, 1e-12);
  // A line is in the drawing's own coordinates, whichever side its plane is seen from.
  const auto line = dxf("0\nLINE\n10\n5\n20\n0\n11\n7\n21\n0\n230\n-1\n");
  EXPECT_NEAR(line.contours.at(0).points_m.front().x(), 5e-3, 1e-12);
}

std::string blocks(const std::string& text) { return "0\nSECTION\n2\nBLOCKS\n" + text + "0\nENDSEC\n"; }

TEST(Dxf, BlocksAreInsertedWhereTheyBelong) {
  // A bar from its base point (1, 1) three to the right, within a pair that holds it twice.
  const std::string head = blocks(
      "0\nBLOCK\n2\nBAR\n70\n0\n10\n1\n20\n1\n0\nLINE\n10\n1\n20\n1\n11\n4\n21\n1\n0\nENDBLK\n8\n0\n"
      "0\nBLOCK\n2\nPAIR\n10\n0\n20\n0\n0\nINSERT\n2\nBAR\n10\n0\n20\n0\n"
      "0\nINSERT\n2\nBAR\n10\n0\n20\n5\n50\n90\n0\nENDBLK\n");
  const auto ends = [](const VectorDrawing& d, std::size_t i, const Vec2& from, const Vec2& to) {
    const auto& p = d.contours.at(i).points_m;
    EXPECT_NEAR((p.front() - 1e-3 * from).norm() + (p.back() - 1e-3 * to).norm(), 0.0, 1e-15) << i;
  };
  const auto one = dxf("0\nINSERT\n2\nBAR\n10\n10\n20\n20\n41\n2\n42\n3\n50\n90\n", head);
  ASSERT_EQ(one.contours.size(), 1u);
  ends(one, 0, {10, 20}, {10, 26});
  const auto nested = dxf("0\nINSERT\n2\nPAIR\n10\n100\n20\n0\n41\n-1\n", head);
  ASSERT_EQ(nested.contours.size(), 2u);
  ends(nested, 0, {100, 0}, {97, 0});
  ends(nested, 1, {100, 5}, {100, 8});
  const auto rows = dxf("0\nINSERT\n2\nBAR\n10\n0\n20\n0\n50\n90\n70\n2\n71\n3\n44\n10\n45\n20\n", head);
  ASSERT_EQ(rows.contours.size(), 6u);
  ends(rows, 5, {-40, 10}, {-40, 13});
  const auto mirrored = dxf("0\nINSERT\n2\nBAR\n10\n10\n20\n0\n230\n-1\n", head);
  ends(mirrored, 0, {-10, 0}, {-13, 0});
}

TEST(Dxf, ACircleInAStretchedBlockIsAnEllipse) {
  const auto d = dxf("0\nINSERT\n2\nC\n10\n0\n20\n0\n41\n100\n42\n50\n",
                     blocks("0\nBLOCK\n2\nC\n10\n0\n20\n0\n0\nCIRCLE\n10\n0\n20\n0\n40\n1\n0\nENDBLK\n"));
  const auto& p = d.contours.at(0).points_m;
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_NEAR(std::hypot(p[i].x() / 0.1, p[i].y() / 0.05), 1.0, 1e-12);
    // The chord's middle stays within the chord error of the curve, magnified or not.
    const Vec2 middle = 0.5 * (p[i] + p[(i + 1) % p.size()]);
    const double off = std::hypot(middle.x() / 0.1, middle.y() / 0.05);
    EXPECT_LT(0.1 * (1.0 - off), 2.1e-7);
  }
}

TEST(Dxf, WhatCannotBeFollowedIsNamed) {
  const auto error = [](const std::string& text, const std::string& head = "") {
    const auto out = read_dxf(entities(text, head));
    return out ? std::string("no error") : out.error();
  };
  const std::string line = "0\nLINE\n10\n0\n20\n0\n11\n2\n21\n0\n";
  const auto d = dxf(line + "0\nTEXT\n1\nA\n0\nHATCH\n10\n0\n0\nTEXT\n0\nVIEWPORT\n67\n1\n" + line +
                     "67\n1\n0\nARC\n40\n1\n210\n0.6\n220\n0\n230\n0.8\n" + line + "60\n1\n");
  EXPECT_EQ(d.contours.size(), 1u);
  EXPECT_EQ(d.unsupported.sentence(), "1 HATCH, 1 LINE on a sheet, 2 TEXT, 1 tilted ARC");
  EXPECT_NE(error(line + "0\nINSERT\n2\nNO\n").find("\"NO\""), std::string::npos);
  const std::string self = blocks("0\nBLOCK\n2\nA\n0\nINSERT\n2\nA\n0\nENDBLK\n");
  EXPECT_NE(error(line + "0\nINSERT\n2\nA\n", self).find("itself"), std::string::npos);
  const std::string other = blocks("0\nBLOCK\n2\nX\n70\n4\n1\nx.dwg\n0\nENDBLK\n");
  EXPECT_NE(error(line + "0\nINSERT\n2\nX\n", other).find("another file"), std::string::npos);
  // A million times a million of a block that draws nothing.
  std::string many =
      "0\nBLOCK\n2\nE\n0\nENDBLK\n0\nBLOCK\n2\nF\n0\nINSERT\n2\nE\n70\n1000000\n71\n1000000\n"
      "0\nENDBLK\n";
  EXPECT_NE(error("0\nINSERT\n2\nF\n", blocks(many)).find("too often"), std::string::npos);
}

TEST(Dxf, DamageIsAnError) {
  EXPECT_FALSE(read_dxf(""));
  EXPECT_FALSE(read_dxf("AutoCAD Binary DXF\r\n"));
  EXPECT_FALSE(read_dxf("hello\nworld\n"));
  EXPECT_FALSE(read_dxf(entities("")));
  EXPECT_FALSE(read_dxf(entities("0\nCIRCLE\n10\nnan\n20\n0\n40\n1\n")));
  EXPECT_FALSE(read_dxf(entities("0\nCIRCLE\n10\n1e400\n20\n0\n40\n1\n")));
  EXPECT_FALSE(read_dxf(entities("0\nSPLINE\n71\n3\n40\n0\n10\n0\n20\n0\n10\n1\n20\n1\n")));
  const auto text = entities("0\nTEXT\n10\n0\n20\n0\n");
  EXPECT_NE(read_dxf(text).error().find("1 TEXT"), std::string::npos);
  const auto unit = read_dxf(entities(text, "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n99\n0\nENDSEC\n"));
  EXPECT_NE(unit.error().find("--units"), std::string::npos) << unit.error();
}

}  // namespace
}  // namespace telekerf::vision
