// SPDX-License-Identifier: Apache-2.0
// What a run's picture and a figure's plots show, at pixels whose place is known.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

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
  const auto file = std::filesystem::path(testing::TempDir()) / "plot.png";
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
