// SPDX-License-Identifier: Apache-2.0
// What a run's picture shows, at pixels whose place is known.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "common/reporting/cut_picture.h"

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

}  // namespace
}  // namespace telekerf::reporting
