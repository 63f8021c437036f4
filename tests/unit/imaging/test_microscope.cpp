// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "slave/vision/imaging/microscope.h"
#include "slave/vision/imaging/sharpness.h"
#include "slave/vision/imaging/targets.h"

namespace telekerf::imaging {
namespace {

constexpr double kZoom_m = 0.04;

Object of(Target target, double structure_px = 1.0) {
  Object object;
  object.metres_per_texel = 1e-5;
  object.texture = draw_target(target, 768, structure_px, 2);
  return object;
}

MicroscopeSettings quiet() {
  MicroscopeSettings settings;
  settings.read_noise = settings.shot_noise = 0.0;
  settings.exposure_per_dof = settings.exposure_per_s = 0.0;
  return settings;
}

TEST(Microscope, IsSharpestOnItsRidge) {
  SimulatedMicroscope scope(quiet(), of(Target::kRelief));
  for (const double zoom_m : {0.01, 0.04, 0.07}) {
    const double focus_m = scope.best_focus_m(zoom_m);
    EXPECT_EQ(scope.defocus_dof({zoom_m, focus_m}), 0.0);
    const double here = sharpness_of(scope.picture({zoom_m, focus_m}, 0.0), {}).tenengrad;
    for (const double off_m : {-0.3e-3, 0.3e-3}) {
      EXPECT_LT(sharpness_of(scope.picture({zoom_m, focus_m + off_m}, 0.0), {}).tenengrad, 0.95 * here);
      EXPECT_NEAR(scope.defocus_dof({zoom_m, focus_m + off_m}),
                  off_m / quiet().model.depth_of_field_m(zoom_m), 1e-9);
    }
  }
}

TEST(Microscope, RaisingTheObjectRaisesTheFocus) {
  SimulatedMicroscope scope(quiet(), of(Target::kRelief));
  const double before = scope.best_focus_m(kZoom_m);
  const double scale = scope.metres_per_pixel({kZoom_m, before});
  scope.object().height_m = 2e-3;
  EXPECT_DOUBLE_EQ(scope.best_focus_m(kZoom_m), before + 2e-3);
  EXPECT_NEAR(scope.metres_per_pixel({kZoom_m, before + 2e-3}), scale, 1e-15);  // in focus as before
  EXPECT_NEAR(scope.metres_per_pixel({kZoom_m, before}) / scale, 1.0 - 2e-3 * 1.5, 1e-9);
}

TEST(Microscope, ShowsThingsAtTheirSizeAndPlace) {
  MicroscopeSettings settings = quiet();
  settings.model.distortion = 0.0;
  settings.model.flat_field = {};
  Object spot;
  spot.metres_per_texel = 1e-5;
  spot.texture = cv::Mat(601, 601, CV_32F, cv::Scalar(200));
  cv::circle(spot.texture, {300, 300}, 30, cv::Scalar(20), cv::FILLED, cv::LINE_AA);
  spot.x_m = 0.4e-3;
  spot.y_m = -0.2e-3;
  SimulatedMicroscope scope(settings, spot);
  const AxisPositions axes{kZoom_m, scope.best_focus_m(kZoom_m)};
  const double scale = scope.metres_per_pixel(axes);
  const cv::Mat dark = 200 - scope.picture(axes, 0.0);
  const cv::Moments moments = cv::moments(dark);
  EXPECT_NEAR(moments.m10 / moments.m00, 63.5 + 0.4e-3 / scale, 0.1);
  EXPECT_NEAR(moments.m01 / moments.m00, 63.5 - 0.2e-3 / scale, 0.1);
  EXPECT_NEAR(moments.m00 / 180.0, M_PI * std::pow(0.3e-3 / scale, 2), 15.0);
}

TEST(Microscope, HasShotAndReadNoise) {
  MicroscopeSettings settings = quiet();
  settings.read_noise = 3.0;
  settings.shot_noise = 4.0;
  settings.model.flat_field = {};
  SimulatedMicroscope scope(settings, of(Target::kBlank));
  const AxisPositions axes{kZoom_m, scope.best_focus_m(kZoom_m)};
  const RestPair pair = compare_at_rest(scope.picture(axes, 0.0), scope.picture(axes, 0.0));
  EXPECT_NEAR(pair.noise_variance, 9.0 + 16.0 * 150.0 / 255.0, 0.8);
  EXPECT_FALSE(pair.moved());
}

TEST(Microscope, TheLightDriftsWithFocusAndTime) {
  MicroscopeSettings settings = quiet();
  settings.exposure_per_dof = 0.01;
  settings.exposure_per_s = 0.002;
  SimulatedMicroscope scope(settings, of(Target::kBlank));
  const double focus_m = scope.best_focus_m(kZoom_m);
  const double dof_m = settings.model.depth_of_field_m(kZoom_m);
  const double mean = grey_sums(scope.picture({kZoom_m, focus_m}, 0.0)).mean();
  EXPECT_NEAR(grey_sums(scope.picture({kZoom_m, focus_m + 5.0 * dof_m}, 0.0)).mean() / mean, 1.05, 0.005);
  EXPECT_NEAR(grey_sums(scope.picture({kZoom_m, focus_m}, 20.0)).mean() / mean, 1.04, 0.005);
}

TEST(Microscope, LosesAThirdOfTheLightInTheCorners) {
  SimulatedMicroscope scope(quiet(), of(Target::kBlank));
  const cv::Mat picture = scope.picture({kZoom_m, scope.best_focus_m(kZoom_m)}, 0.0);
  EXPECT_EQ(picture.at<std::uint8_t>(64, 64), 150);
  EXPECT_NEAR(picture.at<std::uint8_t>(0, 0), 0.65 * 150.0, 12.0);
}

TEST(Microscope, DustIsSharpOnALayerOfItsOwn) {
  MicroscopeSettings settings = quiet();
  settings.dust_specks = 6;
  settings.dust_dof = -6.0;
  SimulatedMicroscope scope(settings, of(Target::kBlank));
  const double focus_m = scope.best_focus_m(kZoom_m);
  const double dof_m = settings.model.depth_of_field_m(kZoom_m);
  const auto darkest = [&](double dof) {
    double least = 0.0;
    cv::minMaxLoc(scope.picture({kZoom_m, focus_m + dof * dof_m}, 0.0), &least);
    return least;
  };
  EXPECT_LT(darkest(-6.0), 60.0);
  EXPECT_GT(darkest(0.0), 85.0);
}

TEST(Microscope, ASpeckIsAsLargeAShareOfEveryPicture) {
  for (const int width : {128, 640}) {
    MicroscopeSettings settings = quiet();
    settings.picture = {width, width};
    settings.model.flat_field = {};
    settings.model.optics.sharpest_px = 0.1;
    settings.dust_specks = 1;
    settings.dust_dof = 0.0;
    SimulatedMicroscope scope(settings, of(Target::kBlank));
    const cv::Mat picture = scope.picture({kZoom_m, scope.best_focus_m(kZoom_m)}, 0.0);
    // Rows that the speck darkens: its diameter, wherever it lies.
    int rows = 0;
    double darkest = 255.0;
    for (int y = 0; y < width; ++y) {
      double least = 255.0;
      cv::minMaxLoc(picture.row(y), &least);
      darkest = std::min(darkest, least);
      if (least < 100.0) ++rows;
    }
    EXPECT_EQ(rows, 2 * 2 * width / 128 + 1) << width;
    EXPECT_NEAR(darkest, 0.25 * 150.0, 2.0);
  }
}

TEST(Microscope, FarOffItShowsAnEvenPictureHoweverFar) {
  SimulatedMicroscope scope(quiet(), of(Target::kRelief));
  const double focus_m = scope.best_focus_m(kZoom_m);
  MicroscopeSettings fine = quiet();
  fine.model.flat_field = {};
  fine.model.optics.numerical_aperture = 1.5;  // depths of field of a few micrometres
  SimulatedMicroscope far(fine, of(Target::kRelief));
  const cv::Mat picture = far.picture({kZoom_m, focus_m + 0.01}, 0.0);
  EXPECT_GT(std::abs(far.defocus_dof({kZoom_m, focus_m + 0.01})), 500.0);
  EXPECT_LT(grey_sums(picture).variance(), 4.0);
}

TEST(Microscope, APixelGathersTheLightOfSeveralTexels) {
  // Stripes of one texel, and of eight, seen by pixels of 1.75 texels: the one is even, the other nearly as
  // it is.
  for (const int texels : {1, 8}) {
    Object stripes;
    stripes.metres_per_texel = 1e-5;
    stripes.texture = cv::Mat(600, 600, CV_32F);
    for (int x = 0; x < 600; ++x) stripes.texture.col(x).setTo(cv::Scalar(x / texels % 2 == 0 ? 100 : 200));
    MicroscopeSettings settings = quiet();
    settings.model.optics.sharpest_px = 0.1;
    settings.model.flat_field = {};
    settings.model.distortion = 0.0;
    settings.model.log_scale = {std::log(1.75e-5), 0.0, 0.0, 0.0};
    SimulatedMicroscope scope(settings, stripes);
    const double deviation =
        std::sqrt(grey_sums(scope.picture({kZoom_m, scope.best_focus_m(kZoom_m)}, 0.0)).variance());
    if (texels == 1) {
      EXPECT_LT(deviation, 12.0);
    } else {
      EXPECT_NEAR(deviation, 45.0, 3.0);
    }
  }
}

TEST(Microscope, IsTheSameForTheSameSeed) {
  SimulatedMicroscope a({}, of(Target::kTissue));
  SimulatedMicroscope b({}, of(Target::kTissue));
  MicroscopeSettings other;
  other.seed = 2;
  SimulatedMicroscope c(other, of(Target::kTissue));
  const AxisPositions axes{0.02, 0.015};
  const cv::Mat first = a.picture(axes, 1.0);
  EXPECT_EQ(cv::norm(first, b.picture(axes, 1.0)), 0.0);
  EXPECT_GT(cv::norm(first, c.picture(axes, 1.0)), 0.0);
  EXPECT_GT(cv::norm(first, a.picture(axes, 1.0)), 0.0);  // its noise goes on
}

TEST(Targets, HaveTheContrastOfTheirKind) {
  for (const auto& row : kTargets) {
    const cv::Mat target = draw_target(row.value, 256, row.value == Target::kGrid ? 40.0 : 1.0, 3);
    ASSERT_EQ(target.type(), CV_32FC1) << row.word;
    ASSERT_EQ(target.size(), cv::Size(256, 256));
    cv::Mat eight;
    target.convertTo(eight, CV_8U);
    const double variance = grey_sums(eight).variance();
    if (row.value == Target::kBlank) {
      EXPECT_EQ(variance, 0.0);
    } else {
      EXPECT_GT(variance, 100.0) << row.word;
    }
    EXPECT_EQ(cv::norm(target, draw_target(row.value, 256, row.value == Target::kGrid ? 40.0 : 1.0, 3)), 0.0);
  }
  EXPECT_GT(cv::norm(draw_target(Target::kRelief, 128, 1.0, 1), draw_target(Target::kRelief, 128, 1.0, 2)),
            0.0);
}

TEST(Targets, TheGridHasItsPitch) {
  const cv::Mat grid = draw_target(Target::kGrid, 201, 40.0, 1);
  for (const int column : {20, 60, 100, 140, 180}) {
    EXPECT_LT(grid.at<float>(100, column), 60.0F) << column;
    EXPECT_GT(grid.at<float>(120, column), 200.0F) << column;
  }
  EXPECT_LT(grid.at<float>(100, 100 + 8), 60.0F);  // a dot is 0.45 of the pitch across
  EXPECT_GT(grid.at<float>(100, 100 + 10), 200.0F);
}

}  // namespace
}  // namespace telekerf::imaging
