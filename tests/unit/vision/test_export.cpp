// SPDX-License-Identifier: Apache-2.0
// Contours as other programs read them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/vision/export/csv.h"
#include "common/vision/export/gcode.h"
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
  const GCode g = to_gcode(
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
  const GCode g = to_gcode(d.contours);
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
