// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
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

TEST(GridView, ADotsMiddleIsItsCentreOfDarkness) {
  constexpr int kFiner =
      8;  // drawn finer, so that a pixel at a dot's edge is as dark as its share of the dot
  cv::Mat fine(200 * kFiner, 300 * kFiner, CV_8U, cv::Scalar(220));
  const std::vector<cv::Point2d> truth{{60.25, 50.5}, {150.0, 100.75}, {240.5, 149.25}};
  for (const cv::Point2d& dot : truth)
    cv::circle(fine, {cvRound((dot.x + 0.5) * kFiner - 0.5), cvRound((dot.y + 0.5) * kFiner - 0.5)},
               9 * kFiner, cv::Scalar(30), cv::FILLED);
  cv::Mat paper;
  cv::resize(fine, paper, {300, 200}, 0, 0, cv::INTER_AREA);
  for (const cv::Point& edge : {cv::Point(0, 80), {100, 0}, {120, 199}, {299, 60}})
    cv::circle(paper, edge, 9, cv::Scalar(30), cv::FILLED);
  cv::circle(paper, {299, 20}, 9, cv::Scalar(30), cv::FILLED);          // at the edge
  cv::rectangle(paper, {20, 150, 60, 12}, cv::Scalar(30), cv::FILLED);  // not round
  paper.at<std::uint8_t>(180, 200) = 30;                                // a speck
  cv::circle(paper, {200, 30}, 9, cv::Scalar(195), cv::FILLED);         // hardly darker than the paper
  const auto dots = dots_in(paper);
  ASSERT_EQ(dots.size(), truth.size());
  for (std::size_t i = 0; i < dots.size(); ++i) EXPECT_LT(cv::norm(dots[i] - truth[i]), 0.1) << dots[i];
}

TEST(GridView, TwelvePixelsAreASpeckAndThirteenADot) {
  cv::Mat paper(100, 100, CV_8U, cv::Scalar(220));
  cv::rectangle(paper, {20, 20, 3, 4}, cv::Scalar(30), cv::FILLED);
  EXPECT_TRUE(dots_in(paper).empty());
  paper.at<std::uint8_t>(24, 21) = 30;
  EXPECT_EQ(dots_in(paper).size(), 1U);
}

/// Dots on a lattice with distortion k, drawn where they would be seen, under light that falls off.
cv::Mat distorted_grid(double pitch_px, double k, const cv::Point2d& origin, const ImagingModel& light) {
  const cv::Size size(640, 480);
  cv::Mat out(size, CV_8U, cv::Scalar(220));
  for (int row = -12; row <= 12; ++row) {
    for (int column = -16; column <= 16; ++column) {
      const cv::Point2d straight(origin.x + pitch_px * column, origin.y + pitch_px * row);
      const double stretch = 1.0 + k * straight.dot(straight) / (320.0 * 320.0);
      const cv::Point2d seen = stretch * straight + cv::Point2d(319.5, 239.5);
      cv::circle(out, cv::Point(cvRound(seen.x * 16), cvRound(seen.y * 16)), cvRound(0.22 * pitch_px * 16),
                 cv::Scalar(30), cv::FILLED, cv::LINE_AA, 4);
    }
  }
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      auto& pixel = out.at<std::uint8_t>(y, x);
      pixel = cv::saturate_cast<std::uint8_t>(pixel * light.light(x, y, size));
    }
  }
  return out;
}

TEST(GridView, ReadsTheLatticeWhereverItBegins) {
  ImagingModel light;
  light.flat_field = {0.06, -0.04, -0.2, 0.05};
  for (const cv::Point2d& origin : {cv::Point2d(0.0, 0.0), {13.0, -17.0}, {-18.5, 9.0}}) {
    for (const double k : {-0.04, 0.0, 0.03}) {
      const auto view = measure_grid(distorted_grid(40.0, k, origin, light), 1e-3);
      ASSERT_TRUE(view) << view.error();
      EXPECT_NEAR(view->metres_per_pixel, 1e-3 / 40.0, 2e-4 * 1e-3 / 40.0) << k;
      EXPECT_NEAR(view->distortion, k, 5e-4);
      EXPECT_LT(view->residual_px, 0.05);
      EXPECT_NEAR(view->flat_field[0], 0.06, 2e-3);
      EXPECT_NEAR(view->flat_field[1], -0.04, 2e-3);
      EXPECT_NEAR(view->flat_field[2], -0.2, 4e-3);
      EXPECT_NEAR(view->flat_field[3], 0.05, 4e-3);
      EXPECT_GT(view->dots, 120);
    }
  }
}

TEST(GridView, WantsTwentyFiveDots) {
  for (const int across : {4, 5}) {
    cv::Mat paper(480, 640, CV_8U, cv::Scalar(220));
    for (int row = 0; row < 5; ++row) {
      for (int column = 0; column < across; ++column)
        cv::circle(paper, {200 + 60 * column, 120 + 60 * row}, 13, cv::Scalar(30), cv::FILLED, cv::LINE_AA);
    }
    const auto view = measure_grid(paper, 1e-3);
    EXPECT_EQ(view.has_value(), across == 5);
    if (view) continue;
    EXPECT_EQ(view.error(), "no printed grid is seen: 20 dots in a lattice, at least 25 are needed");
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

/// A unit over a grid whose focus lies at 15 mm. Twenty-four pictures find it; one is taken in it, one below,
/// one above.
struct UnitOverAGrid {
  UnitOverAGrid() : lowest_m(0.015 - 4.0 * dof_m()), scope(settings(), grid()) {}
  static MicroscopeSettings settings() {
    MicroscopeSettings all;
    all.picture = {640, 480};
    all.read_noise = all.shot_noise = 1.0;
    all.model.ridge_m = {0.015, 0.0, 0.0};
    all.model.focus_scale_per_m = 8.0;
    all.ridge_cubic_m = 0.0;
    return all;
  }
  static Object grid() {
    Object grid;
    grid.metres_per_texel = 1e-5;
    grid.texture = draw_target(Target::kGrid, 1801, 50.0, 1);
    return grid;
  }
  static double dof_m() { return settings().model.depth_of_field_m(0.04); }
  /// `look`: told the number of the picture, from 1 on, and where the focus is wanted; says where it comes to
  /// be.
  auto calibrated(const std::function<tl::expected<double, std::string>(int, double)>& look) {
    CalibrationSettings once;
    once.magnifications = 1;
    return calibrate({.zoom = [&](double to_m) -> tl::expected<void, std::string> {
                        axes.magnification_m = to_m;
                        return {};
                      },
                      .look = [&](double to_m) -> tl::expected<cv::Mat, std::string> {
                        const auto place_m = look(++looks, to_m);
                        if (!place_m) return tl::unexpected(place_m.error());
                        axes.focus_m = std::max(lowest_m, *place_m);
                        return scope.picture(axes, 0.0);
                      },
                      .positions = [&] { return axes; },
                      .lowest_m = lowest_m,
                      .highest_m = 0.03},
                     settings().model, once);
  }
  AxisPositions axes{0.04, 0.015};
  int looks = 0;
  double lowest_m;
  SimulatedMicroscope scope;
};

TEST(Calibration, AnAxisThatEndsNearTheFocusDoesNotFalsifyTheScale) {
  UnitOverAGrid unit;
  // Below the focus there is room for a third of a depth of field only: what is seen there is not as far off.
  const auto calibration = unit.calibrated([](int look, double to_m) -> tl::expected<double, std::string> {
    return look == 22 ? std::max(0.015 - 0.35 * UnitOverAGrid::dof_m(), to_m) : to_m;
  });
  ASSERT_TRUE(calibration) << calibration.error();
  EXPECT_EQ(unit.looks, 23);
  EXPECT_NEAR(unit.axes.magnification_m, 0.04, 1e-12);
  EXPECT_NEAR(calibration->model.focus_scale_per_m, 8.0, 0.8);
}

TEST(Calibration, PassesOnWhatTheUnitSaysAtWhicheverPicture) {
  for (const int failing : {1, 2, 20, 21, 22, 23}) {
    UnitOverAGrid unit;
    const auto calibration = unit.calibrated([=](int look, double to_m) -> tl::expected<double, std::string> {
      if (look == failing) return tl::unexpected<std::string>("the axis is stuck");
      return to_m;
    });
    ASSERT_FALSE(calibration) << failing;
    EXPECT_EQ(calibration.error(), "the axis is stuck") << failing;
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
