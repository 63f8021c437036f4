// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "slave/vision/imaging/imaging_model.h"
#include "slave/vision/imaging/sharpness.h"

namespace telekerf::imaging {
namespace {

TEST(Optics, HasTheDepthOfFieldOfItsApertureAndPixels) {
  const Optics optics{
      .wavelength_m = 0.5e-6, .numerical_aperture = 0.1, .refractive_index = 1.0, .pixel_m = 4e-6};
  EXPECT_NEAR(optics.depth_of_field_m(2.0), 50e-6 + 20e-6, 1e-12);
  // A disc of radius z NA: half of it, on pixels of 4 um / 2.
  EXPECT_NEAR(optics.blur_px_per_dof(2.0), 0.5 * 70e-6 * 0.1 / 2e-6, 1e-12);
  EXPECT_NEAR(optics.blur_px(3.0, 2.0), std::hypot(0.6, 3.0 * 1.75), 1e-12);
  EXPECT_NEAR(optics.blur_px(-3.0, 2.0), optics.blur_px(3.0, 2.0), 1e-12);
  EXPECT_DOUBLE_EQ(optics.magnification(2e-6), 2.0);
}

TEST(ImagingModel, HasScaleAndRidgeOverTheMagnification) {
  ImagingModel model;
  EXPECT_NEAR(model.metres_per_pixel({0.0, model.best_focus_m(0.0)}), 25e-6, 1e-8);
  EXPECT_NEAR(model.metres_per_pixel({0.08, model.best_focus_m(0.08)}), 10e-6, 1e-8);
  EXPECT_DOUBLE_EQ(model.best_focus_m(0.0), 0.013);
  EXPECT_DOUBLE_EQ(model.best_focus_m(0.08), 0.016);
  EXPECT_NEAR(model.best_focus_m(0.04), 0.013 + 0.003 - 0.00075, 1e-12);
  model.log_scale = {-10.0, 0.0, 0.5, 0.25};
  EXPECT_NEAR(std::log(model.metres_per_pixel({0.04, model.best_focus_m(0.04)})), -10.0 + 0.125 + 0.03125,
              1e-12);
  EXPECT_NEAR(model.metres_per_pixel({0.04, model.best_focus_m(0.04) + 2e-3}) /
                  model.metres_per_pixel({0.04, model.best_focus_m(0.04)}),
              1.003, 1e-12);
}

TEST(ImagingModel, MagnificationIsThePixelOverItsSize) {
  const ImagingModel model;
  EXPECT_NEAR(model.magnification(0.08), 0.3, 1e-4);
  EXPECT_NEAR(model.depth_of_field_m(0.08), model.optics.depth_of_field_m(model.magnification(0.08)), 1e-15);
}

TEST(ImagingModel, TheLightFallsTowardsTheCorners) {
  ImagingModel model;
  model.flat_field = {0.1, -0.05, -0.2, 0.04};
  const cv::Size picture(101, 81);
  EXPECT_DOUBLE_EQ(model.light(50, 40, picture), 1.0);
  EXPECT_NEAR(model.light(50 + 50.5, 40, picture), 1.0 + 0.1 - 0.2 + 0.04, 1e-12);
  EXPECT_NEAR(model.light(50, 40 + 50.5, picture), 1.0 - 0.05 - 0.2 + 0.04, 1e-12);
}

TEST(FlatWithin, IsTheVarianceOfTheLightInATile) {
  ImagingModel model;
  model.flat_field = {0.2, 0.0, 0.0, 0.0};  // a ramp to the right
  const auto flat = flat_within(model, {160, 160}, {0, 0, 160, 160});
  const double step = 0.2 / 80.0;  // a pixel; a tile is 20 wide
  const double mean = 1.0 + step * (9.5 - 79.5);
  EXPECT_NEAR(flat[0], step * step * (20.0 * 20.0 - 1.0) / 12.0 / (mean * mean), 1e-9);
  EXPECT_NEAR(flat[8], flat[0], 1e-12);
  EXPECT_LT(flat[7], flat[0]);  // brighter there
  for (const double value : flat_within({}, {160, 160}, {0, 0, 160, 160})) EXPECT_EQ(value, 0.0);
}

TEST(PictureCorrection, DoesNothingWhereNothingIsKnown) {
  PictureCorrection correction{ImagingModel()};
  EXPECT_TRUE(correction.idle());
  const cv::Mat picture(40, 60, CV_8U, cv::Scalar(7));
  EXPECT_EQ(correction.apply(picture).data, picture.data);
}

TEST(PictureCorrection, TakesOutTheLight) {
  ImagingModel model;
  model.flat_field = {0.1, 0.05, -0.3, 0.05};
  PictureCorrection correction(model);
  EXPECT_FALSE(correction.idle());
  cv::Mat paper(120, 160, CV_8U);
  for (int y = 0; y < paper.rows; ++y) {
    for (int x = 0; x < paper.cols; ++x)
      paper.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(180.0 * model.light(x, y, paper.size()));
  }
  cv::Mat even;
  cv::absdiff(correction.apply(paper), cv::Scalar(180), even);
  double most = 0.0;
  cv::minMaxLoc(even, nullptr, &most);
  EXPECT_LE(most, 1.0);
  cv::Mat colours;
  cv::cvtColor(paper, colours, cv::COLOR_GRAY2BGR);
  EXPECT_EQ(correction.apply(colours).type(), CV_8UC3);
}

TEST(PictureCorrection, KeepsDepthAndChannels) {
  ImagingModel model;
  model.flat_field = {0.0, 0.0, -0.2, 0.0};
  PictureCorrection correction(model);
  const cv::Mat deep(120, 160, CV_16UC4, cv::Scalar(20000, 30000, 40000, 50000));
  const cv::Mat even = correction.apply(deep);
  ASSERT_EQ(even.type(), CV_16UC4);
  const auto middle = even.at<cv::Vec4w>(60, 80);
  EXPECT_NEAR(middle[0], 20000, 20);
  EXPECT_NEAR(middle[3], 50000, 50);
  EXPECT_NEAR(even.at<cv::Vec4w>(60, 159)[1], 30000 / 0.8, 400);
  // Another size of pictures is prepared for, too.
  EXPECT_EQ(correction.apply(cv::Mat(60, 80, CV_8U, cv::Scalar(100))).size(), cv::Size(80, 60));
}

TEST(PictureCorrection, TakesOutTheDistortion) {
  ImagingModel model;
  model.distortion = -0.05;
  PictureCorrection correction(model);
  cv::Mat picture(201, 201, CV_8U, cv::Scalar(0));
  // A point at 80 of 100.5 half widths from the middle is seen at 80 (1 - 0.05 (80 / 100.5)^2).
  const double seen = 100.0 + 80.0 * (1.0 - 0.05 * std::pow(80.0 / 100.5, 2));
  cv::circle(picture, {static_cast<int>(std::lround(seen * 16)), 1600}, 4 * 16, cv::Scalar(255), cv::FILLED,
             cv::LINE_AA, 4);
  const cv::Moments moments = cv::moments(correction.apply(picture));
  EXPECT_NEAR(moments.m10 / moments.m00, 180.0, 0.15);
  EXPECT_NEAR(moments.m01 / moments.m00, 100.0, 0.05);
}

}  // namespace
}  // namespace telekerf::imaging
