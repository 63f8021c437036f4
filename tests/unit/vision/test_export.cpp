// SPDX-License-Identifier: Apache-2.0
// Contours as other programs read them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include "common/geometry/nearest.h"
#include "common/vision/export/csv.h"
#include "common/vision/export/gcode.h"
#include "common/vision/export/moves.h"
#include "common/vision/export/svg.h"
#include "common/vision/vector/svg/document.h"

namespace telekerf::vision {
namespace {

using geometry::bounding_box;
using geometry::Polyline;

/// On a page of 100 mm, a unit a millimetre.
VectorDrawing drawn(const std::string& body) {
  return read_svg("<svg width='100mm' height='100mm' viewBox='0 0 100 100'>" + body + "</svg>").value();
}

TEST(Export, CsvComesBackExactly) {
  Polyline line{{}, true};
  for (int i = 0; i < 500; ++i)
    line.points_m.emplace_back(0.01 * std::sin(i * 1.7), 0.01 * std::cos(i * 0.9) / 3.0);
  const auto back = points_from_csv(to_csv(line));
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, line.points_m);
}

TEST(Export, BadCsvNamesTheLine) {
  const auto error = [](const char* text) {
    const auto out = points_from_csv(text);
    return out ? std::string("no error") : out.error();
  };
  EXPECT_NE(error("x,y\n0,0\n1,nan\n").find("line 3"), std::string::npos);
  EXPECT_NE(error("nan,nan\n").find("line 1"), std::string::npos);
  EXPECT_NE(error("1\n").find("line 1"), std::string::npos);
  EXPECT_NE(error("1,2,3\n").find("line 1"), std::string::npos);
  EXPECT_NE(error("1,2\nx,y\n").find("line 2"), std::string::npos);
  EXPECT_NE(error("x_m,y_m\n").find("no point"), std::string::npos);
  EXPECT_EQ(error("x_m,y_m\r\n1,2\r\n3,4"), "no error");
}

TEST(Export, SvgRoundTripKeepsTheSize) {
  const auto d = drawn(R"svg(<circle cx="50" cy="50" r="10"/>)svg");
  const auto back = read_svg(to_svg(d.contours));
  ASSERT_TRUE(back);
  EXPECT_NEAR(bounding_box(back->contours[0].points_m).size().x(), 20e-3, 2e-9);
}

TEST(Export, GCodeOfASquareAndALineIsThis) {
  const Polyline square{{{0, 0}, {0.01, 0}, {0.01, 0.01}, {0, 0.01}}, true};
  const Polyline line{{{0.02, 0}, {0.02, 0.01}}, false};
  const GCode g = *to_gcode(
      std::vector<Polyline>{square, line},
      {.cutting_speed_m_per_s = 0.01, .travel_speed_m_per_s = 0.1, .overlap_m = 12e-3, .full_power = 500});
  EXPECT_EQ(
      g.text,
      fmt::format("(telekerf contour: 2 paths, 20.000 x 10.000 mm, 62.000 mm to cut, about {:.1f} s)\n"
                  "(M4: laser power follows the speed; frame: x 0.000 .. 20.000, y 0.000 .. 10.000 mm)\n"
                  "G21 G90 G17\nM5\n"
                  "G0 X0.0000 Y0.0000\nM4 S500\nF600.0\nG1 X10.0000 Y0.0000\nG1 X10.0000 Y10.0000\n"
                  "G1 X0.0000 Y10.0000\nG1 X0.0000 Y0.0000\nG1 X10.0000 Y0.0000\nG1 X10.0000 Y2.0000\nM5\n"
                  "G0 X20.0000 Y0.0000\nM4 S500\nF600.0\nG1 X20.0000 Y10.0000\nM5\nG0 X0 Y0\nM2\n",
                  g.cutting_time_s));
  EXPECT_NEAR(g.cutting_time_s, 6.2 + g.travel_m / 0.1, 1e-9);
  EXPECT_GE(g.travel_m, 0.02);
}

/// Every place that a program of G0, G1, G2, G3 burns, at most 0.01 mm apart, in millimetres; `lines` counts
/// its moves.
std::vector<Vec2> burnt_by(const std::string& program, int& lines) {
  std::vector<Vec2> out;
  std::istringstream in(program);
  Vec2 at(0, 0);
  lines = 0;
  for (std::string text; std::getline(in, text);) {
    int word = 0;
    Vec2 to(0, 0);
    Vec2 centre(0, 0);
    if (std::sscanf(text.c_str(), "G%d X%lf Y%lf I%lf J%lf", &word, &to.x(), &to.y(), &centre.x(),
                    &centre.y()) < 3)
      continue;
    const Vec2 from = at;
    at = to;
    if (word == 0) continue;
    ++lines;
    const Vec2 a = from - (from + centre);
    double turn = 0.0;
    if (word != 1) {
      const Vec2 b = to - (from + centre);
      EXPECT_NEAR(a.norm(), b.norm(), 2e-4) << text << ": a controller refuses an arc of two radii";
      turn = std::atan2(geometry::cross(a, b), a.dot(b));
      if (word == 2 && turn > 0) turn -= 2 * M_PI;
      if (word == 3 && turn < 0) turn += 2 * M_PI;
      EXPECT_LE(std::abs(turn), M_PI + 1e-3) << text;
    }
    const double length = word == 1 ? (to - from).norm() : std::abs(turn) * a.norm();
    const int pieces = 1 + static_cast<int>(length / 0.01);
    for (int k = 0; k <= pieces; ++k) {
      const double part = static_cast<double>(k) / pieces;
      if (word == 1) {
        out.push_back(from + part * (to - from));
      } else {
        out.push_back(from + centre + Eigen::Rotation2Dd(part * turn) * a);
      }
    }
  }
  return out;
}

/// Largest distance of `places` (mm) from the lines, and of the lines' points from `places`.
double deviation_mm(const std::vector<Vec2>& places, const std::vector<Polyline>& lines) {
  double worst = 0.0;
  std::vector<geometry::NearestIndex> indices;
  for (const Polyline& line : lines) indices.emplace_back(line);
  for (const Vec2& p : places) {
    double nearest = 1e9;
    for (const auto& index : indices) nearest = std::min(nearest, 1e3 * index.find(1e-3 * p).distance_m);
    worst = std::max(worst, nearest);
  }
  const geometry::NearestIndex burnt(Polyline{places, false});
  for (const Polyline& line : lines) {
    for (const Vec2& p : line.points_m) worst = std::max(worst, burnt.find(1e3 * p).distance_m);
  }
  return worst;
}

TEST(Export, GCodeWithArcsCutsTheSameLineInFarFewerMoves) {
  const auto d = drawn(R"svg(<circle cx="20" cy="20" r="10"/>
    <path d="M40,10 H60 A5,5 0 0 1 60,20 H40 A5,5 0 0 0 40,10 Z"/>
    <path fill="none" stroke="black" d="M10,60 C20,40 40,90 60,60"/>
    <rect x="70" y="70" width="8" height="6"/>)svg");
  ASSERT_EQ(d.contours.size(), 4u);
  for (const int passes : {1, 2}) {
    int straight = 0;
    int arcs = 0;
    const double by_lines =
        deviation_mm(burnt_by(to_gcode(d.contours, {.passes = passes})->text, straight), d.contours);
    const GCode g = *to_gcode(d.contours, {.passes = passes, .arcs = true});
    const double by_arcs = deviation_mm(burnt_by(g.text, arcs), d.contours);
    EXPECT_LE(by_lines, 2.1e-3) << "2 micrometres are allowed";
    EXPECT_LE(by_arcs, 2.1e-3);
    EXPECT_NE(g.text.find("G91.1\n"), std::string::npos);
    EXPECT_EQ(to_gcode(d.contours)->text.find("G91.1"), std::string::npos);
    // A circle is two half ones and 0.2 mm beyond its start, the slot two lines and two half circles.
    EXPECT_LE(arcs, passes * 33) << "of " << straight;
    EXPECT_GE(straight, passes * 190);
  }
}

TEST(Export, ASquareIsNoArcThoughItsCornersLieOnOne) {
  const auto moves =
      moves_along(std::vector<Vec2>{{0, 0}, {1e-2, 0}, {1e-2, 1e-2}, {0, 1e-2}, {0, 0}}, 2e-6, true);
  ASSERT_EQ(moves.size(), 4u);
  for (const Move& move : moves) EXPECT_FALSE(move.arc);
  EXPECT_TRUE(moves_along({}, 2e-6, true).empty());
  EXPECT_TRUE(moves_along(std::vector<Vec2>{{1, 1}}, 2e-6, true).empty());
}

TEST(Export, GCodeMovesClosedContoursByHalfTheKerfAndItsOriginToWhereItIsAsked) {
  const Polyline plate{{{0, 0}, {0.02, 0}, {0.02, 0.02}, {0, 0.02}}, true};
  const Polyline hole{{{0.005, 0.005}, {0.01, 0.005}, {0.01, 0.01}, {0.005, 0.01}}, true};
  const Polyline line{{{0.03, 0}, {0.03, 0.01}}, false};
  const auto g =
      to_gcode(std::vector<Polyline>{plate, hole, line}, {.kerf_m = 0.2e-3, .origin_m = Vec2(1e-3, 2e-3)});
  ASSERT_TRUE(g);
  int lines = 0;
  std::vector<Vec2> places = burnt_by(g->text, lines);
  for (Vec2& p : places) p += Vec2(1, 2);
  const auto inside = [&](const geometry::Box& box, const Vec2& p) {
    return p.x() > box.min.x() && p.x() < box.max.x() && p.y() > box.min.y() && p.y() < box.max.y();
  };
  int of_hole = 0;
  int of_plate = 0;
  for (const Vec2& p : places) {
    if (p.x() > 29) {
      EXPECT_NEAR(p.x(), 30.0, 1e-9) << "an open line stays";
    } else if (inside({{4, 4}, {11, 11}}, p)) {
      ++of_hole;
      EXPECT_NEAR(std::max(std::abs(p.x() - 7.5), std::abs(p.y() - 7.5)), 2.4, 3e-3);
    } else {
      ++of_plate;
      const geometry::NearestIndex index(plate);
      EXPECT_NEAR(1e3 * index.find(1e-3 * p).distance_m, 0.1, 3e-3);
      EXPECT_FALSE(inside({{0, 0}, {20, 20}}, p));
    }
  }
  EXPECT_GT(of_hole, 1900);
  EXPECT_GT(of_plate, 8000);
  const auto narrow = to_gcode(std::vector<Polyline>{plate, hole}, {.kerf_m = 6e-3});
  ASSERT_FALSE(narrow);
  EXPECT_EQ(narrow.error(),
            "contour 1: it is somewhere narrower than the kerf of 6 mm; use a smaller --kerf-um");
}

TEST(Export, GCodeSaysTheLengthAndWaysThatItsMovesHave) {
  const Polyline square{{{0.01, 0.01}, {0.02, 0.01}, {0.02, 0.02}, {0.01, 0.02}}, true};
  const Polyline line{{{0.03, 0.01}, {0.05, 0.01}}, false};
  for (const int passes : {1, 2}) {
    for (const double overlap_m : {0.0, 1e-3, 1.0}) {  // beyond a whole lap nothing is left to close
      const GCode g = *to_gcode(std::vector<Polyline>{square, line},
                                {.cutting_speed_m_per_s = 0.01, .overlap_m = overlap_m, .passes = passes});
      double cut_mm = 0.0;
      double travel_mm = 0.0;
      Vec2 at(0, 0);
      std::istringstream in(g.text);
      for (std::string text; std::getline(in, text);) {
        int word = 0;
        Vec2 to(0, 0);
        if (std::sscanf(text.c_str(), "G%d X%lf Y%lf", &word, &to.x(), &to.y()) < 3) continue;
        (word == 0 ? travel_mm : cut_mm) += (to - at).norm();
        at = to;
      }
      EXPECT_EQ(at, Vec2(0, 0));
      EXPECT_NEAR(cut_mm, passes * 60.0 + std::min(1e3 * overlap_m, 40.0), 1e-3);
      EXPECT_NEAR(1e3 * g.travel_m, travel_mm, 1e-3) << passes << ' ' << overlap_m;
      EXPECT_NEAR(g.cutting_time_s, 1e-3 * cut_mm / 0.01 + 1e-3 * travel_mm / 0.05, 1e-4);
      EXPECT_NE(g.text.find(fmt::format(" {:.3f} mm to cut", cut_mm)), std::string::npos) << g.text;
    }
  }
}

TEST(Export, WhatIsSmallerThanAMoveOfGCodeIsNamed) {
  const Polyline square{{{0, 0}, {0.01, 0}, {0.01, 0.01}, {0, 0.01}}, true};
  const Polyline speck{{{0.02, 0}, {0.020001, 0}, {0.020001, 1e-6}}, true};
  const GCode g = *to_gcode(std::vector<Polyline>{square, speck});
  ASSERT_EQ(g.warnings.size(), 1u);
  EXPECT_EQ(g.warnings[0], "contour 1: is smaller than a move of 0.005 mm, so it is not cut");
  EXPECT_EQ(g.text.find("M4 S"), g.text.rfind("M4 S")) << g.text;
}

TEST(Export, SvgOfALineIsThis) {
  const Polyline line{{{0.01, 0.02}, {0.03, 0.05}}, false};
  const Polyline triangle{{{0.01, 0.02}, {0.02, 0.02}, {0.01, 0.03}}, true};
  EXPECT_EQ(to_svg(std::vector<Polyline>{line, triangle}),
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"22.000000mm\" height=\"32.000000mm\" "
            "viewBox=\"0 0 22.000000 32.000000\">\n"
            "<path fill=\"none\" stroke=\"black\" stroke-width=\"0.1\" d=\"M1.000000 31.000000 L21.000000 "
            "1.000000 \"/>\n"
            "<path fill=\"none\" stroke=\"black\" stroke-width=\"0.1\" d=\"M1.000000 31.000000 L11.000000 "
            "31.000000 "
            "L1.000000 21.000000 Z\"/>\n</svg>\n");
}

TEST(Export, GCodeCutsHolesFirstAndClosesContours) {
  const auto d = drawn(R"svg(<circle cx="50" cy="50" r="20"/><circle cx="50" cy="50" r="5"/>)svg");
  const GCode g = *to_gcode(d.contours);
  EXPECT_NE(g.text.find("G21 G90"), std::string::npos);
  EXPECT_NEAR(g.cutting_time_s, (2 * M_PI * 25e-3 + 0.4e-3) / 8e-3 + g.travel_m / 0.05, 0.01);
  // The first way goes to the hole, 5 mm from the middle.
  double x = 0.0;
  double y = 0.0;
  ASSERT_EQ(std::sscanf(g.text.c_str() + g.text.find("G0 X"), "G0 X%lf Y%lf", &x, &y), 2);
  EXPECT_NEAR(std::hypot(x - 50, y + 50), 5.0, 1e-3);
  // Every cut is switched on and off.
  const auto count = [&](const std::string& word) {
    int n = 0;
    for (std::size_t at = g.text.find(word); at != std::string::npos; at = g.text.find(word, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("M4 S1000"), 2);
  EXPECT_EQ(count("\nM5\n"), 3);
}

}  // namespace
}  // namespace telekerf::vision
