// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "experiments/autofocus/focus_zoom.h"
#include "slave/vision/imaging/calibration.h"
#include "slave/vision/imaging/targets.h"

namespace telekerf::imaging {
namespace {

/// The grid in focus, without noise.
cv::Mat grid_picture(double metres_per_pixel, double x_m = 0.0, int width = 640) {
  MicroscopeSettings settings;
  settings.picture = {width, width * 3 / 4};
  settings.read_noise = settings.shot_noise = 0.0;
  settings.ridge_cubic_m = 0.0;
  settings.model.log_scale = {std::log(metres_per_pixel), 0.0, 0.0, 0.0};
  Object grid;
  grid.metres_per_texel = 1e-5;
  grid.texture = draw_target(Target::kGrid, 1801, 50.0, 1);
  grid.x_m = x_m;
  SimulatedMicroscope scope(settings, grid);
  return scope.picture({0.04, scope.best_focus_m(0.04)}, 0.0);
}

TEST(GridView, MeasuresScaleDistortionAndLight) {
  for (const double metres_per_pixel : {12e-6, 17.3e-6, 24e-6}) {
    const auto view = measure_grid(grid_picture(metres_per_pixel, 0.13e-3), 0.5e-3);
    ASSERT_TRUE(view) << view.error();
    EXPECT_NEAR(view->metres_per_pixel / metres_per_pixel, 1.0, 2e-4);
    EXPECT_NEAR(view->distortion, -0.01, 1e-3);
    EXPECT_NEAR(view->flat_field[0], 0.0, 0.004);
    EXPECT_NEAR(view->flat_field[1], 0.0, 0.004);
    EXPECT_NEAR(view->flat_field[2], simulated_model().flat_field[2], 0.01);
    EXPECT_NEAR(view->flat_field[3], simulated_model().flat_field[3], 0.01);
    EXPECT_LT(view->residual_px, 0.06);
    EXPECT_GT(view->dots, 100);
  }
}

TEST(GridView, DoesNotMindATurnedGrid) {
  const cv::Mat straight = grid_picture(17e-6);
  for (const double degrees : {-20.0, 7.0, 30.0}) {
    cv::Mat turned;
    const cv::Point2f middle(0.5F * static_cast<float>(straight.cols - 1),
                             0.5F * static_cast<float>(straight.rows - 1));
    cv::warpAffine(straight, turned, cv::getRotationMatrix2D(middle, degrees, 1.0), straight.size(),
                   cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    const auto view = measure_grid(turned, 0.5e-3);
    ASSERT_TRUE(view) << degrees << ": " << view.error();
    EXPECT_NEAR(view->metres_per_pixel / 17e-6, 1.0, 3e-4) << degrees;
    EXPECT_NEAR(view->distortion, -0.01, 2e-3) << degrees;
  }
}

TEST(GridView, LeavesOutDotsThatDirtHasPushedAside) {
  cv::Mat dirty = grid_picture(17e-6);
  for (int i = 0; i < 6; ++i) cv::circle(dirty, {60 + 95 * i, 50 + 70 * i}, 9, cv::Scalar(30), cv::FILLED);
  const auto view = measure_grid(dirty, 0.5e-3);
  ASSERT_TRUE(view) << view.error();
  EXPECT_NEAR(view->metres_per_pixel / 17e-6, 1.0, 3e-4);
}

TEST(GridView, RefusesWhatIsNoGrid) {
  cv::Mat letters;
  draw_target(Target::kLetter, 480, 1.0, 1).convertTo(letters, CV_8U);
  const auto view = measure_grid(letters, 0.5e-3);
  ASSERT_FALSE(view);
  EXPECT_NE(view.error().find("grid"), std::string::npos) << view.error();
  EXPECT_FALSE(measure_grid(cv::Mat(480, 640, CV_8U, cv::Scalar(200)), 0.5e-3));
}

TEST(GridView, RefusesDotsThatLieOnNoSquareLattice) {
  cv::Mat paper(480, 640, CV_8U, cv::Scalar(220));
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 11; ++column)
      cv::circle(paper, {40 + 55 * column, 40 + 48 * row}, 10, cv::Scalar(30), cv::FILLED, cv::LINE_AA);
  }
  const auto view = measure_grid(paper, 0.5e-3);
  ASSERT_FALSE(view);
  EXPECT_NE(view.error().find("square lattice"), std::string::npos) << view.error();
}

TEST(Calibration, FindsTheTruthOfAUnit) {
  const Calibration calibration = experiments::calibrated_unit(3);
  const MicroscopeSettings truth;
  ASSERT_EQ(calibration.views.size(), 6U);
  ASSERT_EQ(calibration.places.size(), 6U);
  EXPECT_NEAR(calibration.model.distortion, truth.model.distortion, 5e-4);
  EXPECT_NEAR(calibration.model.focus_scale_per_m, truth.model.focus_scale_per_m, 0.1);
  EXPECT_NEAR(calibration.model.flat_field[2], truth.model.flat_field[2], 0.01);
  EXPECT_LT(calibration.scale_residual, 5e-4);
  for (double m = 1e-3; m < 0.08; m += 3e-3) {
    const double found = calibration.model.metres_per_pixel({m, calibration.model.best_focus_m(m)});
    EXPECT_NEAR(found / truth.model.metres_per_pixel({m, truth.model.best_focus_m(m)}), 1.0, 5e-4) << m;
    // The grid lay 1 mm higher.
    EXPECT_NEAR(calibration.model.best_focus_m(m), truth.model.best_focus_m(m) + 1e-3, 0.7e-3) << m;
  }
}

TEST(Calibration, SaysWhereItWasThatNothingWasFound) {
  const CalibrationRig rig{.zoom = [](double) -> tl::expected<void, std::string> { return {}; },
                           .look = [](double) -> tl::expected<cv::Mat, std::string> {
                             return cv::Mat(480, 640, CV_8U, cv::Scalar(120));
                           },
                           .positions =
                               [] {
                                 return AxisPositions{0.002, 0.015};
                               },
                           .lowest_m = 0.0,
                           .highest_m = 0.03};
  const auto calibration = calibrate(rig, {}, {});
  ASSERT_FALSE(calibration);
  EXPECT_EQ(calibration.error(), "no focus on the grid with the magnification axis at 2.00 mm: blank");
}

TEST(Calibration, PassesOnWhatTheUnitSays) {
  CalibrationRig rig{.zoom = [](double) -> tl::expected<void, std::string> {
                       return tl::unexpected<std::string>("the axis is stuck");
                     },
                     .look = [](double) -> tl::expected<cv::Mat, std::string> {
                       return tl::unexpected<std::string>("no camera");
                     },
                     .positions = [] { return AxisPositions{}; }};
  EXPECT_EQ(calibrate(rig, {}, {}).error(), "the axis is stuck");
  rig.zoom = [](double) -> tl::expected<void, std::string> { return {}; };
  EXPECT_EQ(calibrate(rig, {}, {}).error(), "no camera");
}

}  // namespace
}  // namespace telekerf::imaging
