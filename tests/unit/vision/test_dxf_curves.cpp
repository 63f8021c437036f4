// SPDX-License-Identifier: Apache-2.0
// Arcs, ellipses, bulges and units as CAD programs write them, against closed forms.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "common/vision/vector/curve_writer.h"
#include "common/vision/vector/dxf/document.h"

namespace telekerf::vision {
namespace {

using geometry::length_m;
using geometry::Polyline;

std::string entities(const std::string& text, const std::string& header = "") {
  return header + "0\nSECTION\n2\nENTITIES\n" + text + "0\nENDSEC\n0\nEOF\n";
}

Polyline drawn(const std::string& text, const std::string& header = "") {
  const auto out = read_dxf(entities(text, header));
  EXPECT_TRUE(out) << out.error() << " of\n" << text;
  if (!out) return {{Vec2::Zero(), Vec2::Zero()}, false};
  EXPECT_EQ(out->contours.size(), 1u) << text;
  return out->contours.front();
}

struct Arc {
  double from_deg, to_deg;
  double turn_deg;  ///< what is drawn, counter-clockwise
};

TEST(DxfArcs, TurnFromTheirStartToTheirEnd) {
  for (const Arc& arc :
       {Arc{0, 90, 90},           Arc{0, 360, 360},   Arc{360, 720, 360},   Arc{-180, 180, 360},
        Arc{90, 90, 360},         Arc{0, 0, 360},     Arc{270, 90, 180},    Arc{350, 10, 20},
        Arc{10, 350, 340},        Arc{-30, 30, 60},   Arc{30, -30, 300},    Arc{0, 450, 90},
        Arc{720, 90, 90},         Arc{0, 0.01, 0.01}, Arc{45, 405, 360},    Arc{180, 540, 360},
        Arc{0.1, 0, 359.9},       Arc{400, 40, 360},  Arc{360.5, 0.5, 360}, Arc{372.8, 12.8, 360},
        Arc{0, 360.00000001, 360}}) {
    for (const bool down : {false, true}) {  // seen from below: mirrored
      const Polyline line = drawn(fmt::format("0\nARC\n10\n100\n20\n50\n40\n10\n50\n{}\n51\n{}\n{}",
                                              arc.from_deg, arc.to_deg, down ? "230\n-1\n" : ""));
      const double turn = arc.turn_deg * M_PI / 180.0;
      const auto what = testing::Message() << arc.from_deg << " to " << arc.to_deg << (down ? ", down" : "");
      EXPECT_NEAR(length_m(line), 10e-3 * turn, 1e-4 * 10e-3 * turn) << what;
      const Vec2 centre(down ? -0.1 : 0.1, 0.05);
      const double side = down ? -1.0 : 1.0;
      const auto at = [&](double deg) {
        return Vec2(centre + 10e-3 * Vec2(side * std::cos(deg * M_PI / 180), std::sin(deg * M_PI / 180)));
      };
      for (const Vec2& p : line.points_m) EXPECT_NEAR((p - centre).norm(), 10e-3, 1e-12) << what;
      EXPECT_NEAR((line.points_m.front() - at(arc.from_deg)).norm(), 0.0, 1e-12) << what;
      if (!line.closed) {
        EXPECT_NEAR((line.points_m.back() - at(arc.to_deg)).norm(), 0.0, 1e-12) << what;
      }
      EXPECT_EQ(line.closed, arc.turn_deg == 360) << what;
      const Vec2& first = line.points_m.front() - centre;
      const Vec2& second = line.points_m[1] - centre;
      EXPECT_GT(side * geometry::cross(first, second), 0.0) << what;
    }
  }
}

TEST(DxfEllipses, TurnFromTheirStartToTheirEnd) {
  const double full = 6.283185307179586;
  const double quarter = full / 4;
  // 2 by 1: the perimeter is 8 E(3/4) (complete elliptic integral, m = 3/4): 9.688448220547675.
  const double perimeter = 9.688448220547675;
  for (const auto& [from, to, share] : {std::tuple{0.0, full, 1.0},
                                        {full, 2 * full, 1.0},
                                        {-M_PI, M_PI, 1.0},
                                        {0.0, 0.0, 1.0},
                                        {1.0, 1.0, 1.0},
                                        {1.0, 1.0 + full, 1.0},
                                        {0.0, 6.28318530718, 1.0},
                                        {0.0, 6.2831853072, 1.0},
                                        {0.0, 6.283185307, 1.0},
                                        {0.0, quarter, 0.25},
                                        {quarter, 0.0, 0.75},
                                        {3 * quarter, quarter, 0.5},
                                        {-quarter, quarter, 0.5},
                                        {full, quarter, 0.25}}) {
    for (const bool down : {false, true}) {
      const Polyline line =
          drawn(fmt::format("0\nELLIPSE\n10\n5\n20\n7\n11\n0\n21\n20\n40\n0.5\n41\n{}\n42\n{}\n{}", from, to,
                            down ? "230\n-1\n" : ""));
      const auto what = testing::Message() << from << " to " << to << (down ? ", down" : "");
      EXPECT_NEAR(length_m(line), 10e-3 * perimeter * share, 3e-6) << what;
      EXPECT_EQ(line.closed, share == 1.0) << what;
      // The major axis points up: the minor one to the left, and seen from below to the right.
      const double minor = down ? 10e-3 : -10e-3;
      const auto at = [&](double t) { return Vec2(5e-3 + minor * std::sin(t), 7e-3 + 20e-3 * std::cos(t)); };
      EXPECT_NEAR((line.points_m.front() - at(from)).norm(), 0.0, 1e-12) << what;
      if (!line.closed) {
        EXPECT_NEAR((line.points_m.back() - at(to)).norm(), 0.0, 1e-12) << what;
      }
      const Vec2 centre(5e-3, 7e-3);
      EXPECT_GT((down ? -1 : 1) * geometry::cross(line.points_m[0] - centre, line.points_m[1] - centre), 0.0)
          << what;
    }
  }
}

TEST(DxfUnits, EachIsItsLength) {
  for (const auto& [unit, metres] : {std::pair{0, 1e-3},
                                     {1, 25.4e-3},
                                     {2, 0.3048},
                                     {4, 1e-3},
                                     {5, 1e-2},
                                     {6, 1.0},
                                     {3, 1609.344},
                                     {7, 1e3},
                                     {8, 25.4e-9},
                                     {9, 25.4e-6},
                                     {10, 0.9144},
                                     {12, 1e-9},
                                     {13, 1e-6},
                                     {14, 0.1},
                                     {15, 10.0},
                                     {21, 1200.0 / 3937.0}}) {
    const std::string header = fmt::format("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n{}\n0\nENDSEC\n", unit);
    EXPECT_NEAR(length_m(drawn("0\nLINE\n10\n1\n20\n1\n11\n4\n21\n5\n", header)) / metres, 5.0, 1e-12)
        << unit;
  }
  for (const char* unit : {"-1", "25", "99", "mm"}) {
    const std::string header = fmt::format("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n{}\n0\nENDSEC\n", unit);
    const auto out = read_dxf(entities("0\nLINE\n11\n4\n", header));
    ASSERT_FALSE(out) << unit;
    EXPECT_NE(out.error().find(unit), std::string::npos) << out.error();
  }
}

TEST(DxfBulges, AreArcsOfFourTimesTheirAngle) {
  for (const double bulge : {1.0, -1.0, 0.5, -0.25, 0.01, 2.0, -3.0, 1e-6}) {
    const Polyline line = drawn(fmt::format("0\nLWPOLYLINE\n10\n0\n20\n0\n42\n{}\n10\n6\n20\n8\n", bulge));
    const double angle = 4.0 * std::atan(std::abs(bulge));
    const double radius = 5e-3 / std::sin(0.5 * angle);
    EXPECT_NEAR(length_m(line), radius * angle, 3e-6 * std::max(1.0, radius * angle / 10e-3)) << bulge;
    EXPECT_EQ(line.points_m.front(), Vec2(0, 0));
    EXPECT_NEAR((line.points_m.back() - Vec2(6e-3, 8e-3)).norm(), 0.0, 1e-15);
    // A positive bulge lies to the right of its chord, as high as half the chord times itself.
    double right = 0.0, left = 0.0;
    for (const Vec2& p : line.points_m) {
      const double off = geometry::cross(Vec2(0.6, 0.8), p);
      right = std::max(right, -off);
      left = std::max(left, off);
    }
    EXPECT_NEAR(bulge > 0 ? right : left, 5e-3 * std::abs(bulge), 3e-7) << bulge;
    EXPECT_NEAR(bulge > 0 ? left : right, 0.0, 1e-12) << bulge;
  }
}

TEST(DxfEntities, WhatHasNoSizeDrawsNothing) {
  const std::string line = "0\nLINE\n10\n1\n20\n1\n11\n4\n21\n5\n";
  const std::string at = "10\n3\n20\n3\n";
  for (const auto& [nothing, named] :
       {std::pair("0\nCIRCLE\n" + at + "40\n0\n", "1 CIRCLE without a radius"),
        {"0\nARC\n" + at + "40\n-1\n50\n0\n51\n90\n", "1 ARC without a radius"},
        {"0\nLINE\n" + at + "11\n3\n21\n3\n", ""},
        {"0\nLWPOLYLINE\n10\n1\n20\n2\n70\n1\n", ""},
        {"0\nATTDEF\n10\n1\n", ""},
        {"0\nCIRCLE\n" + at + "40\n1\n60\n1\n", ""}}) {
    const auto out = read_dxf(entities(nothing + line));
    ASSERT_TRUE(out) << nothing;
    EXPECT_EQ(out->contours.size(), 1u) << nothing;
    EXPECT_EQ(out->unsupported.sentence(), named) << nothing;
  }
  EXPECT_FALSE(read_dxf(entities("0\nCIRCLE\n" + at + "40\n0\n")));
}

TEST(DxfEntities, WhatIsDamagedIsRefusedAndSaysWhere) {
  const std::string whole = entities("0\nLINE\n10\n1\n20\n1\n11\n4\n21\n5\n");
  ASSERT_TRUE(read_dxf(whole));
  // Cut off anywhere within the section it is not taken for a drawing; a file without its last line is.
  const std::size_t section = whole.find("LINE");
  const std::size_t end = whole.find("0\nENDSEC");
  for (std::size_t size = section; size < end; ++size) EXPECT_FALSE(read_dxf(whole.substr(0, size))) << size;
  EXPECT_TRUE(read_dxf(whole.substr(0, whole.find("0\nEOF"))));
  for (const char* number : {"1,5", "2O", "20mm", "0x14", "1 2"}) {
    const auto out = read_dxf(entities(fmt::format("0\nLINE\n10\n1\n20\n{}\n11\n4\n21\n5\n", number)));
    ASSERT_FALSE(out) << number;
    EXPECT_NE(out.error().find(number), std::string::npos) << out.error();
  }
  for (const auto& [entity, group] : {std::pair("LINE\n10\n1\n20\n1\n21\n5\n", 11),
                                      {"LINE\n20\n1\n11\n2\n21\n5\n", 10},
                                      {"CIRCLE\n10\n0\n20\n0\n", 40},
                                      {"ARC\n10\n0\n20\n0\n40\n1\n50\n3\n", 51}}) {
    const auto out = read_dxf(entities(fmt::format("0\n{}", entity)));
    ASSERT_FALSE(out) << entity;
    EXPECT_NE(out.error().find(fmt::format("no group {}:", group)), std::string::npos) << out.error();
  }
}

TEST(DxfEntities, DashedLinesAreSaidToBeCutWhole) {
  const std::string tables =
      "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n0\nLAYER\n2\nA\n70\n0\n6\nHIDDEN2\n0\nLAYER\n2\nB\n70\n0\n6"
      "\nContinuous\n0\nENDTAB\n0\nENDSEC\n";
  const auto notes = [&](const std::string& words) {
    const auto out = read_dxf(entities("0\nLINE\n" + words + "10\n1\n20\n1\n11\n4\n21\n5\n", tables));
    EXPECT_TRUE(out) << words;
    std::string all;
    for (const std::string& note : out->notes) all += note;
    return all;
  };
  const std::string said = "1 dashed lines are cut whole (line type)";
  for (const char* dashed : {"8\na\n", "8\nB\n6\nDASHED\n", "8\nA\n6\nByLayer\n"})
    EXPECT_NE(notes(dashed).find(said), std::string::npos) << dashed;
  for (const char* whole : {"8\nB\n", "8\nA\n6\nCONTINUOUS\n", "8\nC\n"})
    EXPECT_EQ(notes(whole).find(said), std::string::npos) << whole;
}

TEST(DxfBlocks, AreFoundInAnyCapitals) {
  const auto out = read_dxf(
      "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nPart\n10\n0\n20\n0\n0\nLINE\n10\n1\n20\n1\n11\n4\n21\n5\n0\nENDBLK"
      "\n0\nENDSEC\n" +
      entities("0\nINSERT\n2\nPART\n10\n0\n20\n0\n"));
  ASSERT_TRUE(out) << out.error();
  EXPECT_EQ(out->contours.size(), 1u);
}

TEST(DxfEntities, WhatRisesOutOfThePlaneIsNamedAndNotProjected) {
  const std::string line = "0\nLINE\n10\n1\n20\n1\n30\n7\n11\n4\n21\n5\n31\n7\n";  // at one height
  const std::string spline =
      "0\nSPLINE\n71\n1\n70\n0\n40\n0\n40\n0\n40\n1\n40\n1\n10\n0\n20\n0\n30\n{}\n10\n9\n20\n0\n30\n2\n";
  const std::string ellipse =
      "0\nELLIPSE\n10\n0\n20\n0\n30\n3\n11\n5\n21\n0\n31\n{}\n40\n0.5\n41\n0\n42\n6.283185307\n";
  const auto seen = [&](const std::string& text) {
    const auto out = read_dxf(entities(text + line));
    EXPECT_TRUE(out) << text;
    return std::pair(out->contours.size(), out->unsupported.sentence());
  };
  using Seen = std::pair<std::size_t, std::string>;
  EXPECT_EQ(seen("0\nLINE\n10\n0\n20\n0\n30\n0\n11\n9\n21\n0\n31\n0.1\n"),
            Seen(1, "1 LINE that is not flat"));
  EXPECT_EQ(seen("0\nLINE\n10\n0\n20\n0\n11\n9\n21\n0\n"), Seen(2, ""));
  EXPECT_EQ(seen(fmt::format(fmt::runtime(spline), "2")), Seen(2, ""));
  EXPECT_EQ(seen(fmt::format(fmt::runtime(spline), "2.1")), Seen(1, "1 SPLINE that is not flat"));
  EXPECT_EQ(seen(fmt::format(fmt::runtime(ellipse), "0")), Seen(2, ""));
  EXPECT_EQ(seen(fmt::format(fmt::runtime(ellipse), "1")), Seen(1, "1 ELLIPSE that is not flat"));
}

TEST(CurveWriter, TakesAsManyStepsAsTheChordErrorAsks) {
  constexpr double kError = 1e-3;
  CurveWriter circle(kError, 1'000'000);
  circle.ellipse({0, 0}, {10, 0}, {0, 10}, 0.0, 2.0 * M_PI);
  // A chord of angle a is 10 (1 - cos(a / 2)) off: between half and all of the error that is allowed.
  const auto n = static_cast<double>(circle.points().size() - 1);
  EXPECT_EQ(std::fmod(n, 4.0), 0.0);
  EXPECT_LE(10.0 * (1.0 - std::cos(M_PI / n)), kError);
  EXPECT_GE(10.0 * (1.0 - std::cos(M_PI / n)), 0.9 * kError);
  CurveWriter flat(kError, 1'000'000);
  flat.ellipse({0, 0}, {10, 0}, {0, 10}, 0.0, 1e-6);
  EXPECT_EQ(flat.points().size(), 9u) << "eight steps at least";

  CurveWriter cubic(kError, 1'000'000);
  cubic.move_to({0, 0});
  cubic.quadratic_to({5, 10}, {10, 0});  // y'' = 40 over t: an error of 5 / n^2
  EXPECT_EQ(cubic.points().size(), 1u + static_cast<std::size_t>(std::ceil(std::sqrt(5.0 / kError))));
  CurveWriter straight(kError, 1'000'000);
  straight.move_to({0, 0});
  straight.cubic_to({1, 0}, {2, 0}, {3, 0});
  EXPECT_EQ(straight.points().size(), 2u);
}

TEST(CurveWriter, IsFullBehindItsLastPoint) {
  CurveWriter writer(1.0, 3);
  writer.move_to({0, 0});
  writer.line_to({1, 0});
  writer.line_to({2, 0});
  EXPECT_FALSE(writer.full());
  writer.line_to({3, 0});
  EXPECT_TRUE(writer.full());
  EXPECT_EQ(writer.points().size(), 3u);
  for (const Vec2& bad : {Vec2(NAN, 0), Vec2(0, INFINITY)}) {
    CurveWriter other(1.0, 9);
    other.move_to({0, 0});
    other.line_to(bad);
    EXPECT_TRUE(other.bad());
    EXPECT_EQ(other.points().size(), 1u);
    CurveWriter curve(1.0, 9);
    curve.move_to({0, 0});
    curve.cubic_to(bad, {1, 1}, {2, 2});
    EXPECT_TRUE(curve.bad());
    CurveWriter arc(1.0, 9);
    arc.ellipse({0, 0}, bad, {1, 0}, 0.0, 1.0);
    EXPECT_TRUE(arc.bad());
  }
}

/// The four arcs of an ellipse from one point to another, by their middle: SVG's F.6.5.
TEST(CurveWriter, ArcsTakeTheSideThatTheirFlagsName) {
  // Circle of 5 through (0, 0) and (6, 0): centres (3, 4) and (3, -4), y upwards here.
  for (const auto& [large, sweep, centre_y] :
       {std::tuple{false, true, 4.0}, {true, true, -4.0}, {false, false, -4.0}, {true, false, 4.0}}) {
    CurveWriter writer(1e-6, 1'000'000);
    writer.move_to({0, 0});
    writer.arc_to({5, -5}, 0.7, large, sweep, {6, 0});
    const auto what = testing::Message() << large << sweep;
    double length = 0.0, turned = 0.0;
    const auto& p = writer.points();
    for (std::size_t i = 0; i < p.size(); ++i) {
      EXPECT_NEAR((p[i] - Vec2(3, centre_y)).norm(), 5.0, 1e-9) << what;
      if (i > 0) length += (p[i] - p[i - 1]).norm();
      if (i > 0) turned += geometry::cross(p[i - 1] - Vec2(3, centre_y), p[i] - Vec2(3, centre_y));
    }
    const double small = 10.0 * std::asin(0.6);
    EXPECT_NEAR(length, large ? 10.0 * M_PI - small : small, 1e-4) << what;
    EXPECT_EQ(turned > 0.0, sweep) << what;
    EXPECT_EQ(p.back(), Vec2(6, 0));
  }
  CurveWriter half(1e-6, 1'000'000);  // too small a radius: stretched until it reaches
  half.move_to({0, 0});
  half.arc_to({1, 1}, 0.0, false, true, {6, 0});
  double length = 0.0;
  for (std::size_t i = 1; i < half.points().size(); ++i)
    length += (half.points()[i] - half.points()[i - 1]).norm();
  EXPECT_NEAR(length, 3.0 * M_PI, 1e-4);
  CurveWriter none(1e-6, 100);
  none.move_to({0, 0});
  none.arc_to({0, 3}, 0.0, false, true, {6, 0});
  EXPECT_EQ(none.points().size(), 2u) << "a radius of nothing is a straight line";
  none.arc_to({3, 3}, 0.0, false, true, {6, 0});
  EXPECT_EQ(none.points().size(), 2u) << "to where it is: nothing";
  // A turned ellipse of 2 by 1 over its long axis.
  CurveWriter turned(1e-6, 1'000'000);
  turned.move_to({-std::sqrt(2.0), -std::sqrt(2.0)});
  turned.arc_to({2, 1}, M_PI / 4, false, true, {std::sqrt(2.0), std::sqrt(2.0)});
  for (const Vec2& q : turned.points()) {
    const double u = (q.x() + q.y()) / std::sqrt(2.0), v = (q.y() - q.x()) / std::sqrt(2.0);
    EXPECT_NEAR(u * u / 4.0 + v * v, 1.0, 1e-9);
    EXPECT_LE(v, 1e-9);
  }
}

}  // namespace
}  // namespace telekerf::vision
