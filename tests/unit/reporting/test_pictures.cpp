// SPDX-License-Identifier: Apache-2.0
// What a run's picture and a figure's plots show, at pixels whose place is known.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "common/reporting/cut_picture.h"
#include "common/reporting/plot.h"
#include "common/runtime/startup_error.h"

namespace telekerf::reporting {
namespace {

/// A square contour of 10 mm; burnt along y = 2 mm, then on with the laser off along y = -2 mm.
RunRecord run(double laser_w) {
  RunRecord record;
  record.contour_m = {{-5e-3, -5e-3}, {5e-3, -5e-3}, {5e-3, 5e-3}, {-5e-3, 5e-3}};
  for (int i = 0; i < 400; ++i) {
    SlaveRow row;
    row.t_s = i * 1e-3;
    const bool burns = i < 200;
    row.tool_m = {-2e-3 + 20e-6 * (i % 200), burns ? 2e-3 : -2e-3, 0.0};
    row.laser_w = burns ? laser_w : 0.0;
    record.slave.push_back(row);
  }
  return record;
}

// 1.2 times the reach of 5 mm to either side: 10 um a pixel.
cv::Vec3b at(const cv::Mat& picture, double x_mm, double y_mm) {
  return picture.at<cv::Vec3b>(static_cast<int>(std::lround(599.5 - 100.0 * y_mm)),
                               static_cast<int>(std::lround(599.5 + 100.0 * x_mm)));
}

int brightness(const cv::Vec3b& pixel) { return pixel[0] + pixel[1] + pixel[2]; }

TEST(CutPicture, WhatWasBurntIsDarkAndBareWoodIsLight) {
  const cv::Mat picture = draw_cut(run(10.0));
  ASSERT_EQ(picture.size(), cv::Size(1200, 1200));
  for (const double x_mm : {-1.5, 0.0, 1.5}) {
    EXPECT_LT(brightness(at(picture, x_mm, 2.0)), 120) << "burnt";
    EXPECT_GT(brightness(at(picture, x_mm, 3.0)), 500) << "bare";
    EXPECT_GT(brightness(at(picture, x_mm, 1.0)), 500);
  }
  // 10 W over 20 mm/s is 0.5 J a mm: over a spot of 60 um it chars fully; a hundredth of it hardly colours.
  EXPECT_GT(brightness(at(draw_cut(run(0.05)), 0.0, 2.0)), 400);
  EXPECT_NEAR(brightness(at(draw_cut(run(1.0)), 0.0, 2.0)), 395, 20) << "and in between it is brown";
}

TEST(CutPicture, TheContourIsBlueAndThePathWithTheLaserOffIsGrey) {
  RunRecord record = run(10.0);
  for (const bool closed : {true, false}) {
    record.contour_closed = closed;
    const cv::Mat picture = draw_cut(record);
    const auto blue = [&](double x_mm, double y_mm) {
      // A line of one pixel between two rows.
      const cv::Vec3b a = at(picture, x_mm, y_mm);
      const cv::Vec3b b = at(picture, x_mm - 0.01, y_mm + 0.01);
      return a[0] > a[2] || b[0] > b[2];
    };
    EXPECT_TRUE(blue(0.0, 5.0));
    EXPECT_TRUE(blue(5.0, 1.0));
    EXPECT_TRUE(blue(1.0, -5.0));
    EXPECT_EQ(blue(-5.0, 1.0), closed) << "the side that closes it";
    EXPECT_FALSE(blue(0.0, 0.0));
    const int grey = std::min(brightness(at(picture, 1.0, -2.0)), brightness(at(picture, 1.0, -1.99)));
    EXPECT_LT(grey, 480);
    EXPECT_GT(grey, 330);
  }
}

/// The first panel's plot is 394 x 240 pixels, from (70, 34) on.
cv::Mat drawn(const Panel& panel) {
  const auto file = std::filesystem::path(testing::TempDir()) / "plot-curves.png";
  draw_figure({.panels = {panel}}, file);
  return cv::imread(file.string());
}

bool coloured(const cv::Mat& picture, double u, double v) {
  const cv::Vec3b p = picture.at<cv::Vec3b>(34 + static_cast<int>(std::lround(240 * (1.0 - v))),
                                            70 + static_cast<int>(std::lround(394 * u)));
  return std::max({p[0], p[1], p[2]}) - std::min({p[0], p[1], p[2]}) > 60;
}

TEST(Plot, ALineRunsWhereItsValuesAre) {
  Panel panel;
  panel.lines = {{.x = {0, 1, 2}, .y = {0, 10, 0}}};
  panel.x_range = {{0, 2}};
  panel.y_range = {{0, 20}};
  const cv::Mat picture = drawn(panel);
  ASSERT_EQ(picture.size(), cv::Size(480, 320));
  EXPECT_TRUE(coloured(picture, 0.5, 0.5));
  EXPECT_TRUE(coloured(picture, 0.25, 0.25));
  EXPECT_TRUE(coloured(picture, 0.75, 0.25));
  EXPECT_FALSE(coloured(picture, 0.5, 0.25));
  EXPECT_FALSE(coloured(picture, 0.25, 0.75));
}

TEST(Plot, LogarithmicAxesAndGapsAndDashes) {
  Panel panel;
  panel.lines = {{.x = {1, 10, 100}, .y = {1, 1000, 1}}};
  panel.x_range = {{1, 100}};
  panel.y_range = {{1, 1e6}};
  panel.log_x = panel.log_y = true;
  const cv::Mat logarithmic = drawn(panel);
  EXPECT_TRUE(coloured(logarithmic, 0.5, 0.5));
  EXPECT_TRUE(coloured(logarithmic, 0.25, 0.25));
  panel.log_x = panel.log_y = false;
  panel.x_range = {{0, 4}};
  panel.y_range = {{0, 2}};
  panel.lines = {{.x = {0, 1, NAN, 3, 4}, .y = {1, 1, 1, 1, 1}}};
  const cv::Mat gap = drawn(panel);
  EXPECT_TRUE(coloured(gap, 0.125, 0.5));
  EXPECT_FALSE(coloured(gap, 0.5, 0.5)) << "a NaN leaves a gap";
  EXPECT_TRUE(coloured(gap, 0.875, 0.5));
  panel.lines = {{.x = {0, 4}, .y = {1, 1}, .style = Line::Style::kDashed}};
  const cv::Mat dashed = drawn(panel);
  int on = 0;
  for (int column = 0; column < 394; ++column) on += coloured(dashed, column / 394.0, 0.5);
  EXPECT_NEAR(on / 394.0, 0.766, 0.03) << "7 of 13 pixels, and the ends of dashes that are two wide";
  EXPECT_TRUE(coloured(dashed, 4 / 394.0, 0.5)) << "a dash first";
  EXPECT_FALSE(coloured(dashed, 10 / 394.0, 0.5));
  panel.lines = {{.x = {2}, .y = {1}, .style = Line::Style::kPoints}};
  const cv::Mat points = drawn(panel);
  EXPECT_TRUE(coloured(points, 0.5, 0.5));
  EXPECT_FALSE(coloured(points, 0.52, 0.5));
}

TEST(Plot, WithoutARangeEverythingIsSeenAndEqualAxesShowACircleRound) {
  Panel panel;
  Line circle;
  for (int i = 0; i <= 360; ++i) {
    circle.x.push_back(3.0 + std::cos(i * M_PI / 180));
    circle.y.push_back(std::sin(i * M_PI / 180));
  }
  panel.lines = {circle};
  // Room of 0.06 above and below; none at the sides.
  const cv::Mat stretched = drawn(panel);
  EXPECT_TRUE(coloured(stretched, 0.5, 1.0 - 0.06 / 1.12));
  EXPECT_TRUE(coloured(stretched, 0.5, 0.06 / 1.12));
  panel.equal_axes = true;
  const cv::Mat round = drawn(panel);
  const double radius_px = 240.0 / (1.12 * 1.05) / 2.0;
  for (const double way : {-1.0, 1.0}) {
    EXPECT_TRUE(coloured(round, 0.5 + way * radius_px / 394.0, 0.5));
    EXPECT_TRUE(coloured(round, 0.5, 0.5 + way * radius_px / 240.0));
  }
}

/// Where there is ink (dark and grey, as texts are) within a part of the picture.
cv::Rect ink(const cv::Mat& picture, const cv::Rect& part) {
  cv::Mat dark;
  cv::inRange(picture(part), cv::Scalar(0, 0, 0), cv::Scalar(200, 200, 200), dark);
  cv::Rect found = cv::boundingRect(dark);
  found.x += part.x;
  found.y += part.y;
  return found;
}

double middle_x(const cv::Rect& box) { return box.x + 0.5 * box.width; }
double middle_y(const cv::Rect& box) { return box.y + 0.5 * box.height; }

int width_of(const std::string& words, double scale = 0.42) {
  int base = 0;
  return cv::getTextSize(words, cv::FONT_HERSHEY_SIMPLEX, scale, 1, &base).width;
}

/// Columns or rows of the plot's grid, but for its frame, from the plot's corner on.
std::vector<int> grid(const cv::Mat& picture, bool columns, int width = 394) {
  std::vector<int> found;
  for (int i = 1; i < (columns ? width : 240) - 1; ++i) {
    const cv::Vec3b p =
        columns ? picture.at<cv::Vec3b>(34 + 7, 70 + i) : picture.at<cv::Vec3b>(34 + i, 70 + 5);
    if (p == cv::Vec3b(228, 228, 228)) found.push_back(i);
  }
  return found;
}

TEST(Plot, TicksAreRoundNumbersWithTheirLabelsInTheMiddle) {
  Panel panel;
  panel.title = "a title";
  panel.x_label = "along, mm";
  panel.y_label = "error, um";
  panel.x_range = {{0, 2}};
  panel.y_range = {{0, 20}};
  const cv::Mat picture = drawn(panel);
  EXPECT_EQ(grid(picture, true), (std::vector<int>{98, 197, 296})) << "every half";
  EXPECT_EQ(grid(picture, false), (std::vector<int>{60, 120, 180})) << "every five";
  const cv::Rect one = ink(picture, {70 + 197 - 40, 34 + 240 + 4, 80, 16});
  EXPECT_NEAR(middle_x(one), 70 + 197, 2.0);
  EXPECT_NEAR(one.width, width_of("1.0"), 3) << "as many decimals as the step has";
  EXPECT_NEAR(one.y + one.height, 34 + 240 + 17, 1.5);
  const cv::Rect ten = ink(picture, {20, 34 + 120 - 10, 46, 20});
  EXPECT_NEAR(ten.x + ten.width, 64, 2.0) << "to the left of the frame";
  EXPECT_NEAR(ten.width, width_of("10"), 3);
  EXPECT_NEAR(middle_y(ten), 34 + 120, 1.5);
  const cv::Rect title = ink(picture, {70, 8, 394, 24});
  EXPECT_NEAR(middle_x(title), 70 + 197, 2.0);
  EXPECT_NEAR(title.width, width_of("a title", 0.46), 4);
  EXPECT_NEAR(title.y + title.height, 34 - 8, 1.5);
  const cv::Rect x_label = ink(picture, {70, 34 + 240 + 22, 394, 24});
  EXPECT_NEAR(middle_x(x_label), 70 + 197, 2.0);
  EXPECT_NEAR(x_label.width, width_of("along, mm"), 4);
  const cv::Rect y_label = ink(picture, {0, 34, 24, 240});
  EXPECT_NEAR(middle_y(y_label), 34 + 120, 2.0);
  EXPECT_NEAR(middle_x(y_label), 12, 3.0);
  EXPECT_NEAR(y_label.height, width_of("error, um"), 4);
}

TEST(Plot, StepsAreOneTwoOrFiveAndWideNumbersAreShortened) {
  Panel panel;
  panel.y_range = {{0, 1}};
  const auto columns = [&](double high) {
    panel.x_range = {{0, high}};
    return grid(drawn(panel), true).size();
  };
  EXPECT_EQ(columns(6.0), 5u) << "0 to 6 by ones";
  EXPECT_EQ(columns(6.1), 3u) << "by twos";
  EXPECT_EQ(columns(12.1), 2u) << "by fives";
  EXPECT_EQ(columns(30.0), 5u);
  EXPECT_EQ(columns(31.0), 3u) << "by tens";
  const auto label = [&](double high) {
    panel.x_range = {{0, high}};
    return ink(drawn(panel), {20, 34 + 240 + 6, 85, 14}).width;
  };
  EXPECT_NEAR(label(9e4), width_of("0"), 3);
  EXPECT_NEAR(label(1e5), width_of("0.0e+00"), 4);
  EXPECT_NEAR(label(6e-4), width_of("0.0000"), 4);
  EXPECT_NEAR(label(6e-5), width_of("0.0e+00"), 4);
  panel.log_x = true;
  panel.x_range = {{1, 1e6}};
  EXPECT_EQ(grid(drawn(panel), true).size(), 5u) << "each power of ten";
  panel.x_range = {{1, 1e12}};
  EXPECT_EQ(grid(drawn(panel), true).size(), 5u) << "every second one";
  // Without any value that is finite, and of one value alone.
  panel.log_x = false;
  panel.x_range.reset();
  panel.lines = {{.x = {NAN}, .y = {0.5}}};
  EXPECT_EQ(grid(drawn(panel), true), (std::vector<int>{79, 158, 236, 315})) << "0 to 1 by fifths";
  panel.lines = {{.x = {4.0}, .y = {0.5}}};
  EXPECT_EQ(grid(drawn(panel), true), (std::vector<int>{39, 118, 197, 276, 355})) << "3.5 to 4.5";
}

TEST(Plot, ALegendStandsInTheEmptiestCornerOrBesideThePlot) {
  Panel panel;
  panel.x_range = {{0, 1}};
  panel.y_range = {{0, 1}};
  const int width = width_of("first") + 24 + 18;
  const auto frame = [&](const cv::Mat& picture, int x, int y, int rows) {
    const cv::Vec3b line(228, 228, 228);
    const int height = rows * 17 + 8;
    return picture.at<cv::Vec3b>(y, x + width / 2 + 3) == line &&
           picture.at<cv::Vec3b>(y + height - 1, x + width / 2 + 3) == line &&
           picture.at<cv::Vec3b>(y + height / 2 + 3, x) == line &&
           picture.at<cv::Vec3b>(y + height / 2 + 3, x + width - 1) == line;
  };
  const int left = 70 + 6, right = 70 + 394 - 6 - width, top = 34 + 6;
  const auto bottom = [](int rows) { return 34 + 240 - 6 - (rows * 17 + 8); };
  panel.lines = {{.label = "first"}, {.label = "two"}};
  cv::Mat picture = drawn(panel);
  EXPECT_TRUE(frame(picture, right, top, 2));
  const cv::Rect words = ink(picture, {right + 12 + 24, top + 3, width - 38, 16});
  EXPECT_NEAR(words.x, right + 12 + 24, 2);
  EXPECT_NEAR(words.y + words.height, top + 13 + 4, 1.5);
  // Samples of the first two colours, blue and orange, in the middle of their rows.
  const cv::Vec3b blue = picture.at<cv::Vec3b>(top + 13, right + 18);
  const cv::Vec3b orange = picture.at<cv::Vec3b>(top + 13 + 17, right + 18);
  EXPECT_EQ(blue, cv::Vec3b(178, 114, 0));
  EXPECT_EQ(orange, cv::Vec3b(0, 94, 213));
  EXPECT_EQ(picture.at<cv::Vec3b>(top + 13, right + 3), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(picture.at<cv::Vec3b>(top + 13, right + 33), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(picture.at<cv::Vec3b>(top + 13, right + 28), blue);
  panel.lines = {{}, {.label = "first"}};
  EXPECT_EQ(drawn(panel).at<cv::Vec3b>(top + 13, right + 18), orange) << "what has no label takes no row";
  const cv::Vec3b palette[] = {{178, 114, 0}, {0, 94, 213},   {115, 158, 0},  {167, 121, 204},
                               {0, 159, 230}, {233, 180, 86}, {66, 228, 240}, {60, 60, 60}};
  for (int colour = 0; colour < 8; ++colour) {
    panel.lines = {{.label = "first", .colour = colour}};
    EXPECT_EQ(drawn(panel).at<cv::Vec3b>(top + 13, right + 18), palette[colour]) << colour;
  }
  panel.lines = {{.label = "first", .x = {0.8, 1.0}, .y = {0.95, 0.95}}};
  EXPECT_TRUE(frame(drawn(panel), right, bottom(1), 1));
  panel.lines.push_back({.x = {0.8, 1.0}, .y = {0.05, 0.05}});
  EXPECT_TRUE(frame(drawn(panel), left, top, 1)) << "what has no label has no row";
  panel.lines.push_back({.x = {0.0, 0.2}, .y = {0.95, 0.95}});
  EXPECT_TRUE(frame(drawn(panel), left, bottom(1), 1));
  panel.lines.assign(7, {.label = "first"});
  EXPECT_TRUE(frame(drawn(panel), right, top, 7)) << "seven rows are still within";
  panel.lines.assign(8, {.label = "first"});
  picture = drawn(panel);
  EXPECT_TRUE(frame(picture, 70 + 394 - width, 34, 8));
  EXPECT_EQ(picture.at<cv::Vec3b>(34 + 100, 70 + 394 - width - 6 - 1), cv::Vec3b(40, 40, 40))
      << "the plot's frame ends before it";
  panel.lines = {{.label = "first", .style = Line::Style::kPoints, .colour = 9}};
  picture = drawn(panel);
  EXPECT_EQ(picture.at<cv::Vec3b>(top + 13, right + 18), cv::Vec3b(0, 94, 213)) << "colours go round";
  EXPECT_EQ(picture.at<cv::Vec3b>(top + 13, right + 10), cv::Vec3b(255, 255, 255)) << "a point is no line";
}

TEST(Plot, PanelsStandRowByRowAndATitleTakesItsRoom) {
  const auto file = std::filesystem::path(testing::TempDir()) / "plot.png";
  draw_figure({.title = "t",
               .panels = std::vector<Panel>(5),
               .columns = 2,
               .panel_width_px = 300,
               .panel_height_px = 200},
              file);
  EXPECT_EQ(cv::imread(file.string()).size(), cv::Size(600, 634));
  draw_figure({.panels = std::vector<Panel>(2), .columns = 2}, file);
  EXPECT_EQ(cv::imread(file.string()).size(), cv::Size(960, 320));
  EXPECT_THROW(draw_figure({.panels = std::vector<Panel>(1)}, "/nowhere/at/all.png"), StartupError);
}

}  // namespace
}  // namespace telekerf::reporting
