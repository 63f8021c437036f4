// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/workpiece/mark_along_path.h"
#include "common/workpiece/mark_picture.h"
#include "common/workpiece/workpiece.h"

namespace telekerf::workpiece {
namespace {

TEST(Workpiece, EnergyIsConservedWhereverTheBeamStands) {
  Workpiece workpiece({.half_width_m = 0.01, .pixels = 200}, kWood);
  double given = 0.0;
  for (int i = 0; i < 500; ++i) {
    const double angle = 0.37 * i;
    workpiece.absorb({0.012 * std::cos(angle) * (i % 7) / 6.0, 0.012 * std::sin(angle)}, 0.01, 150e-6);
    given += 0.01;
  }
  EXPECT_NEAR(cv::sum(workpiece.energy_j())[0] + workpiece.energy_off_raster_j(), given, 1e-5);
  EXPECT_GT(workpiece.energy_off_raster_j(), 0.0);
}

TEST(Workpiece, WhatNothingHasTouchedIsWhole) {
  const Workpiece workpiece({.half_width_m = 0.01, .pixels = 200}, kWood);
  EXPECT_EQ(cv::countNonZero(workpiece.energy_j()), 0);
  EXPECT_EQ(cv::countNonZero(workpiece.depth_m()), 0);
  EXPECT_EQ(workpiece.depth_m().rows, 200);
  EXPECT_EQ(workpiece.depth_m(Vec2(0, 0)), 0.0);
}

TEST(Workpiece, APulseDigsWhereItFallsAndNoDeeperThanTheMaterialIsThick) {
  Workpiece workpiece({.centre_m = {0.1, -0.2}, .half_width_m = 1e-3, .pixels = 200}, kFibreglass);
  const Vec2 at(0.1 + 0.3e-3, -0.2 + 0.4e-3);
  workpiece.ablate(at, 1e-3, 60e-6);
  const double once = workpiece.depth_m(at);
  EXPECT_GT(once, 0.0);
  EXPECT_EQ(workpiece.depth_m(Vec2(0.1 - 0.3e-3, -0.2 - 0.4e-3)), 0.0);
  workpiece.ablate(at, 1e-3, 60e-6);
  EXPECT_NEAR(workpiece.depth_m(at), 2.0 * once, 1e-9);
  for (int i = 0; i < 1000; ++i) workpiece.ablate(at, 0.1, 60e-6);
  EXPECT_NEAR(workpiece.depth_m(at), workpiece.material().thickness_m, 1e-9);
  EXPECT_TRUE(workpiece.covers(at));
  EXPECT_FALSE(workpiece.covers(Vec2(0, 0)));
}

TEST(Workpiece, UpIsUp) {
  Workpiece workpiece({.half_width_m = 0.01, .pixels = 200}, kWood);
  workpiece.absorb({0.005, 0.008}, 1.0, 30e-6);
  cv::Point brightest;
  cv::minMaxLoc(workpiece.energy_j(), nullptr, nullptr, nullptr, &brightest);
  EXPECT_NEAR(brightest.x, 149.5, 1.0);
  EXPECT_NEAR(brightest.y, 19.5, 1.0);
}

TEST(Material, APulseRemovesWhatIsAboveItsThreshold) {
  EXPECT_EQ(kWood.depth_m(300.0 / 0.7 - 1e-9), 0.0);
  EXPECT_NEAR(kWood.depth_m(1000.0 / 0.7), 700.0 / 60e9, 1e-18);
  EXPECT_NEAR(kFibreglass.depth_m(10000.0), (9000.0 - 1500.0) / 90e9, 1e-18);
}

TEST(Workpiece, ARasterHasAsManyPixelsAsItsWidthNeedsWithinItsBounds) {
  EXPECT_EQ(pixels_for(1e-3, 10e-6), 200);
  EXPECT_EQ(pixels_for(1e-3, 10.04e-6), 199);
  EXPECT_EQ(pixels_for(1e-3, 1e-3), 16);
  EXPECT_EQ(pixels_for(1.0, 1e-6), 8000);
  const Workpiece workpiece({.centre_m = {0.1, 0.2}, .half_width_m = 1e-3, .pixels = 200}, kWood);
  EXPECT_DOUBLE_EQ(workpiece.pixel_m(), 10e-6);
  EXPECT_NEAR(workpiece.pixel_of({0.1, 0.2}).x, 99.5, 1e-9);
  EXPECT_NEAR(workpiece.pixel_of({0.1 + 50e-6, 0.2 + 20e-6}).x, 104.5, 1e-9);
  EXPECT_NEAR(workpiece.pixel_of({0.1 + 50e-6, 0.2 + 20e-6}).y, 97.5, 1e-9);
  EXPECT_TRUE(workpiece.covers({0.10099, 0.19901}));
  EXPECT_FALSE(workpiece.covers({0.10101, 0.2}));
  EXPECT_FALSE(workpiece.covers({0.1, 0.19899}));
}

// 2 E / (pi w^2) in the middle and exp(-2 r^2 / w^2) of it at r.
TEST(Workpiece, APulseDigsAGaussianPit) {
  Workpiece workpiece({.half_width_m = 0.5e-3, .pixels = 501}, kWood);  // a pixel in the middle
  const double radius_m = 60e-6, energy_j = 1e-3;
  workpiece.ablate({0, 0}, energy_j, radius_m);
  for (const int off : {0, 5, -10, 20, 30, 40, 60}) {
    const double r = off * workpiece.pixel_m();
    const double fluence = 2.0 * energy_j / (std::numbers::pi * radius_m * radius_m) *
                           std::exp(-2.0 * r * r / (radius_m * radius_m));
    const double expected =
        std::abs(off) > 1.6 * radius_m / workpiece.pixel_m() + 1 ? 0.0 : kWood.depth_m(fluence);
    EXPECT_NEAR(workpiece.depth_m(Vec2(r, 0)), expected, 1e-4 * kWood.depth_m(1e6)) << off;
    EXPECT_NEAR(workpiece.depth_m(Vec2(0, r)), expected, 1e-4 * kWood.depth_m(1e6)) << off;
  }
  // Between pixels a plane.
  const double half = 0.5 * workpiece.pixel_m();
  const auto at = [&](double x, double y) { return workpiece.depth_m(Vec2(x * 2 * half, y * 2 * half)); };
  EXPECT_NEAR(at(20.5, 7.25),
              0.5 * (0.75 * at(20, 7) + 0.25 * at(20, 8) + 0.75 * at(21, 7) + 0.25 * at(21, 8)), 1e-12);
  // On the raster's edge half a pit is dug, and off it nothing is read.
  workpiece.ablate({-0.5e-3, 0}, energy_j, radius_m);
  EXPECT_GT(workpiece.depth_m(Vec2(-0.4985e-3, 0)), 0.9 * workpiece.depth_m(Vec2(0, 0)));
  EXPECT_EQ(workpiece.depth_m(Vec2(-0.51e-3, 0)), 0.0);
  EXPECT_EQ(workpiece.depth_m(Vec2(0.51e-3, 0)), 0.0);
  EXPECT_EQ(workpiece.depth_m(Vec2(0, -0.51e-3)), 0.0);
}

TEST(Workpiece, EnergyIsSpreadAsTheBeamIs) {
  Workpiece workpiece({.half_width_m = 1e-3, .pixels = 201}, kWood);
  workpiece.absorb({0, 0}, 2.0, 50e-6);
  const cv::Mat energy = workpiece.energy_j();
  const double radius = 50e-6 / workpiece.pixel_m();
  const double middle = energy.at<float>(100, 100);
  EXPECT_NEAR(middle, 2.0 * 2.0 / (std::numbers::pi * radius * radius), 0.002 * middle);
  for (const int off : {1, 3, 6}) {
    const double expected = middle * std::exp(-2.0 * off * off / (radius * radius));
    EXPECT_NEAR(energy.at<float>(100 + off, 100), expected, 1e-5 * middle);
    EXPECT_NEAR(energy.at<float>(100, 100 - off), expected, 1e-5 * middle);
  }
  // Twelve pixels from an edge is as near as a spot of ten of them is kept.
  for (const int column : {12, 11}) {
    Workpiece edge({.half_width_m = 1e-3, .pixels = 201}, kWood);
    edge.absorb({(column - 100) * edge.pixel_m(), 0}, 1.0, 5.5 * edge.pixel_m());
    EXPECT_EQ(edge.energy_off_raster_j(), column == 12 ? 0.0 : 1.0) << column;
  }
}

/// A groove along x whose depth in pixels across is `profile`.
struct Groove {
  explicit Groove(double radius_m, double step_m, double speed_up = 1.0)
      : piece({.half_width_m = 1e-3, .pixels = 401}, kWood) {
    for (double x = -0.9e-3; x <= 0.9e-3; x += x < 0.0 ? step_m : speed_up * step_m)
      piece.ablate({x, 0}, 1e-3, radius_m);
  }
  Workpiece piece;
};

TEST(MarkAlongPath, ItsKerfIsTheWidthAtHalfTheDepth) {
  constexpr double kRadius_m = 60e-6, kStep_m = 2e-6;
  const Groove groove(kRadius_m, kStep_m);
  const geometry::Polyline line{{{-0.5e-3, 0}, {0.5e-3, 0}}, false};
  const MarkAlongPath mark = measure_mark(groove.piece, line, kRadius_m);
  // Depth of the groove at y: the sum of the pits of all pulses.
  const auto depth_at = [&](double y) {
    double sum = 0.0;
    for (double x = -200e-6; x <= 200e-6; x += kStep_m) {
      const double r2 = (x * x + y * y) / (kRadius_m * kRadius_m);
      if (std::abs(x) <= 1.6 * kRadius_m && std::abs(y) <= 1.6 * kRadius_m)
        sum += kWood.depth_m(2.0 * 1e-3 / (std::numbers::pi * kRadius_m * kRadius_m) * std::exp(-2.0 * r2));
    }
    return sum;
  };
  const double deepest = depth_at(0.0);
  double half_m = 0.0;
  while (depth_at(half_m) > 0.5 * deepest) half_m += 0.1e-6;
  EXPECT_NEAR(mark.depth_m, deepest, 0.01 * deepest);
  EXPECT_NEAR(mark.kerf_m, 2.0 * half_m, 2.5e-6) << "in quarters of a pixel of 5 um";
  EXPECT_LT(mark.depth_variation, 0.01);
}

TEST(MarkAlongPath, AStepInDepthIsItsVariation) {
  constexpr double kRadius_m = 40e-6;
  // Half of it has pulses twice as far apart: depths of 1 and 1/2, mean 3/4, off by a third of it.
  const Groove groove(kRadius_m, 2e-6, 2.0);
  const MarkAlongPath mark = measure_mark(groove.piece, {{{-0.5e-3, 0}, {0.5e-3, 0}}, false}, kRadius_m);
  EXPECT_NEAR(mark.depth_variation, 1.0 / 3.0, 0.02);
  // The ends of an open mark do not count: two spot radii at either side.
  const MarkAlongPath ends = measure_mark(groove.piece, {{{-0.9e-3, 0}, {-0.4e-3, 0}}, false}, kRadius_m);
  EXPECT_LT(ends.depth_variation, 0.03);
  const MarkAlongPath none = measure_mark(groove.piece, {{{0, 0.5e-3}, {0.5e-3, 0.5e-3}}, false}, kRadius_m);
  EXPECT_EQ(none.depth_m, 0.0);
  EXPECT_EQ(none.depth_variation, 0.0);
  const MarkAlongPath shorter = measure_mark(groove.piece, {{{0, 0}, {0.1e-3, 0}}, false}, kRadius_m);
  EXPECT_EQ(shorter.depth_m, 0.0) << "shorter than its ends";
}

TEST(MarkPicture, WhatIsBurntIsDarkAndTheRestIsTheMaterials) {
  cv::Mat raster(2, 100, CV_32F, 0.0F);
  for (int c = 0; c < 100; ++c) raster.at<float>(1, c) = 0.01F * static_cast<float>(c);
  const cv::Mat burnt = burnt_fraction(raster, 0.5);
  EXPECT_EQ(burnt.at<float>(0, 50), 0.0F);
  EXPECT_NEAR(burnt.at<float>(1, 50), 1.0 - std::exp(-3.0), 1e-5) << "95 % where it looks fully dark";
  EXPECT_NEAR(burnt.at<float>(1, 25), 1.0 - std::exp(-1.5), 1e-5);
  for (const Material& material : {kWood, kFibreglass}) {
    const cv::Mat picture = mark_picture(cv::Mat(40, 40, CV_32F, 0.0F), material);
    const cv::Mat black = mark_picture(cv::Mat(40, 40, CV_32F, 1.0F), material);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(cv::mean(picture)[k], material.paper_bgr[k], 8.5) << material.name;
      EXPECT_NEAR(cv::mean(black)[k], material.burnt_bgr[k], 1e-9) << material.name;
    }
  }
}

TEST(MarkPicture, AScaleBarIsARoundLengthOfAQuarterAtMost) {
  struct Case {
    double pixel_m;
    double bar_m;
  };
  // 800 pixels: a quarter of the width is 0.2 mm times pixel/um.
  for (const Case& c :
       {Case{10e-6, 2e-3}, Case{9.9e-6, 1e-3}, Case{25e-6, 5e-3}, Case{24.9e-6, 2e-3}, Case{50e-6, 10e-3}}) {
    cv::Mat picture(200, 800, CV_8UC3, cv::Scalar::all(255));
    draw_scale_bar(picture, c.pixel_m, cv::Scalar(0, 0, 255));
    int length = 0;
    for (int x = 0; x < 800; ++x) length += picture.at<cv::Vec3b>(175, x) == cv::Vec3b(0, 0, 255);
    EXPECT_NEAR(length * c.pixel_m, c.bar_m, 4 * c.pixel_m) << c.pixel_m;
    EXPECT_EQ(picture.at<cv::Vec3b>(175, 45), cv::Vec3b(0, 0, 255)) << "from the left";
  }
}

/// Columns of a row that have a colour.
int columns_of(const cv::Mat& picture, int row, const cv::Vec3b& colour) {
  int count = 0;
  for (int x = 0; x < picture.cols; ++x) count += picture.at<cv::Vec3b>(row, x) == colour;
  return count;
}

TEST(MarkPicture, AWorkpiecesPictureHasItsScaleWhateverItsSize) {
  // 8 mm: a quarter is 2 mm, whole or shrunk to half the pixels.
  const Workpiece workpiece({.half_width_m = 4e-3, .pixels = 800}, kWood);
  for (const int pixels : {1200, 400}) {
    const cv::Mat picture = picture_of(workpiece, pixels);
    const int width = std::min(pixels, 800);
    ASSERT_EQ(picture.cols, width);
    ASSERT_EQ(picture.rows, width + 60) << "with the bar below";
    const cv::Vec3b ink(kWood.burnt_bgr[0], kWood.burnt_bgr[1], kWood.burnt_bgr[2]);
    EXPECT_NEAR(columns_of(picture, picture.rows - 25, ink), width / 4, 4) << pixels;
    const cv::Mat map = depth_picture(workpiece, pixels);
    ASSERT_EQ(map.cols, width + 130) << "with the colours' scale beside it";
    EXPECT_NEAR(columns_of(map(cv::Rect(0, 0, width, map.rows)), map.rows - 25, {255, 255, 255}), width / 4,
                4)
        << pixels;
  }
}

TEST(MarkPicture, TheMapsColoursRunFromWholeToTheDeepest) {
  Workpiece workpiece({.half_width_m = 1e-3, .pixels = 200}, kWood);
  const auto at = [](const cv::Mat& picture, int row, int column) {
    return picture.at<cv::Vec3b>(row, column);
  };
  const cv::Mat whole = depth_picture(workpiece);
  const cv::Vec3b lowest = at(whole, 5, 5);
  EXPECT_EQ(at(whole, 100, 100), lowest);
  workpiece.ablate({0, 0}, 1e-3, 60e-6);
  const cv::Mat map = depth_picture(workpiece);
  EXPECT_EQ(at(map, 5, 5), lowest);
  cv::Point deepest;
  cv::minMaxLoc(workpiece.depth_m(), nullptr, nullptr, nullptr, &deepest);
  const int bar = map.cols - 130 + 12 + 8;
  EXPECT_EQ(at(map, 30, bar), at(map, deepest.y, deepest.x)) << "the deepest above";
  EXPECT_EQ(at(map, 29 + map.rows / 2, bar), lowest) << "the whole below";
  EXPECT_EQ(at(map, 29, bar), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(at(map, 30 + map.rows / 2, bar), cv::Vec3b(255, 255, 255));
  EXPECT_NE(at(map, 30, bar), lowest);
}

}  // namespace
}  // namespace telekerf::workpiece
