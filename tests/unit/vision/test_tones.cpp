// SPDX-License-Identifier: Apache-2.0
// Drawings in more than one tone: pencil beside ink, a shape of two greys, light and dark on a ground between
// them, dots beside lines, dashes. What is drawn is found, or named; none of it is lost without a word.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/vision/load.h"

namespace telekerf::vision {
namespace {

constexpr double kPaper = 245.0;

cv::Mat sheet(double grey = kPaper) { return cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(grey)); }

void disc(cv::Mat& picture, const cv::Point& centre, int radius, double grey) {
  cv::circle(picture, centre, radius, cv::Scalar::all(grey), cv::FILLED, cv::LINE_AA);
}

void ring(cv::Mat& picture, const cv::Point& centre, int radius, double grey) {
  cv::circle(picture, centre, radius, cv::Scalar::all(grey), 7, cv::LINE_AA);
}

/// Blurred, lit from one side, with grain: the same each time.
cv::Mat photographed(const cv::Mat& drawing) {
  cv::Mat out;
  cv::GaussianBlur(drawing, out, {}, 1.0);
  cv::RNG rng(7);
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) {
      for (int c = 0; c < 3; ++c) {
        auto& value = out.at<cv::Vec3b>(y, x)[c];
        value = cv::saturate_cast<unsigned char>((1.0 - 0.2 * x / out.cols) * value + rng.gaussian(4.0));
      }
    }
  }
  return out;
}

/// Lengths of the contours in pixels, longest first.
std::vector<double> lengths_in(const cv::Mat& picture, const PictureRequest& request = {}) {
  const auto found = contours_in(picture, request);
  if (!found) {
    ADD_FAILURE() << found.error();
    return {};
  }
  std::vector<double> out;
  for (const PixelContour& c : found->contours) out.push_back(length_px(c));
  std::sort(out.rbegin(), out.rend());
  return out;
}

TEST(Tones, APalerShapeBesideADarkOneIsFoundToo) {
  for (const double grey : {130.0, 160.0, 190.0, 215.0}) {
    cv::Mat discs = sheet();
    disc(discs, {180, 240}, 90, 30);
    disc(discs, {460, 240}, 90, grey);
    cv::Mat rings = sheet();
    ring(rings, {180, 240}, 90, 30);
    ring(rings, {460, 240}, 90, grey);
    for (const cv::Mat& drawing : {discs, rings}) {
      for (const cv::Mat& picture : {drawing, photographed(drawing)}) {
        const auto lengths = lengths_in(picture);
        ASSERT_EQ(lengths.size(), 2u) << grey;
        for (const double length : lengths) EXPECT_NEAR(length, 2.0 * M_PI * 90.3, 4.0) << grey;
      }
    }
  }
}

TEST(Tones, AShapeOfTwoGreysIsOneShape) {
  for (const double grey : {130.0, 160.0, 190.0, 215.0}) {
    cv::Mat picture = sheet();
    disc(picture, {320, 240}, 120, 30);
    cv::Mat paler = sheet();
    disc(paler, {320, 240}, 120, grey);
    paler(cv::Rect(320, 0, 320, 480)).copyTo(picture(cv::Rect(320, 0, 320, 480)));
    for (const cv::Mat& seen : {picture, photographed(picture)}) {
      const auto lengths = lengths_in(seen);
      ASSERT_EQ(lengths.size(), 1u) << grey;
      EXPECT_NEAR(lengths[0], 2.0 * M_PI * 120.5, 8.0) << grey;
    }
  }
}

TEST(Tones, WhatIsDrawnOnSomethingPaleIsKeptBesideIt) {
  cv::Mat core = sheet();
  disc(core, {320, 240}, 120, 160);
  disc(core, {320, 240}, 60, 40);
  auto lengths = lengths_in(core);
  ASSERT_EQ(lengths.size(), 2u);
  EXPECT_NEAR(lengths[0], 2.0 * M_PI * 120.5, 4.0);
  EXPECT_NEAR(lengths[1], 2.0 * M_PI * 60.5, 4.0);
  cv::Mat line = sheet();
  disc(line, {320, 240}, 150, 190);
  cv::circle(line, {320, 240}, 80, cv::Scalar::all(30), 6, cv::LINE_AA);
  lengths = lengths_in(line);
  ASSERT_EQ(lengths.size(), 2u);
  EXPECT_NEAR(lengths[0], 2.0 * M_PI * 150.5, 4.0);
  EXPECT_NEAR(lengths[1], 2.0 * M_PI * 80.0, 4.0);
}

TEST(Tones, FiveGreysAreFiveShapes) {
  cv::Mat picture = sheet();
  int at = 80;
  for (const double grey : {30.0, 80.0, 130.0, 180.0, 220.0}) {
    disc(picture, {at, 240}, 45, grey);
    at += 120;
  }
  for (const cv::Mat& seen : {picture, photographed(picture)}) {
    const auto lengths = lengths_in(seen);
    ASSERT_EQ(lengths.size(), 5u);
    for (const double length : lengths) EXPECT_NEAR(length, 2.0 * M_PI * 45.5, 6.0);
  }
}

TEST(Tones, LightAndDarkOnAGroundBetweenThemAreBothFound) {
  cv::Mat picture = sheet(128);
  disc(picture, {180, 240}, 90, 20);
  disc(picture, {460, 240}, 90, 240);
  for (const cv::Mat& seen : {picture, photographed(picture)}) {
    const auto lengths = lengths_in(seen);
    ASSERT_EQ(lengths.size(), 2u);
    for (const double length : lengths) EXPECT_NEAR(length, 2.0 * M_PI * 90.5, 5.0);
  }
}

TEST(Tones, ShadowsAndSmudgesAreNoPalerShapes) {
  cv::Mat hard = sheet();
  ring(hard, {320, 240}, 100, 30);
  cv::Mat soft = hard.clone();
  cv::Mat shaded = hard(cv::Rect(0, 300, 640, 180));
  shaded *= 0.7;
  cv::Mat smudge(soft.size(), CV_32F, cv::Scalar(0));
  cv::ellipse(smudge, {420, 330}, {120, 60}, 20, 0, 360, cv::Scalar(1), cv::FILLED);
  cv::GaussianBlur(smudge, smudge, {}, 12.0);
  for (int y = 0; y < soft.rows; ++y) {
    for (int x = 0; x < soft.cols; ++x) soft.at<cv::Vec3b>(y, x) *= 1.0 - 0.35 * smudge.at<float>(y, x);
  }
  for (const cv::Mat& picture : {hard, soft}) {
    const auto lengths = lengths_in(photographed(picture));
    ASSERT_EQ(lengths.size(), 1u);
    EXPECT_NEAR(lengths[0], 2.0 * M_PI * 100.0, 5.0);
  }
}

TEST(Tones, DotsBesideALineAreKeptOrCounted) {
  cv::Mat picture = sheet();
  cv::line(picture, {60, 60}, {600, 60}, cv::Scalar::all(20), 6, cv::LINE_AA);
  constexpr int kDots = 6;
  for (int i = 0; i < kDots; ++i) disc(picture, {100 + 80 * i, 200}, 3 + 2 * i, 20);
  const auto found = contours_in(picture, {});
  ASSERT_TRUE(found) << found.error();
  EXPECT_EQ(found->contours.size() + static_cast<std::size_t>(found->left_out.small), 1u + kDots);
  EXPECT_GT(found->contours.size(), 2u);
  PictureRequest all;
  all.extraction.min_size_px = 2.0;
  const auto lengths = lengths_in(picture, all);
  ASSERT_EQ(lengths.size(), 1u + kDots);
  for (std::size_t i = 0; i < kDots; ++i)
    EXPECT_NEAR(lengths[1 + i], 2.0 * M_PI * (13.5 - 2.0 * static_cast<double>(i)), 9.0) << i;
}

TEST(Dashes, AreNamed) {
  cv::Mat dashed = sheet();
  for (int i = 0; i < 24; ++i)
    cv::ellipse(dashed, {320, 240}, {150, 150}, 0, 15 * i, 15 * i + 9, cv::Scalar::all(30), 5, cv::LINE_AA);
  for (const cv::Mat& seen : {dashed, photographed(dashed)}) {
    const auto found = contours_in(seen, {});
    ASSERT_TRUE(found) << found.error();
    EXPECT_EQ(found->contours.size(), 24u);
    EXPECT_NE(found->why.find("24 of 24 contours are dashes"), std::string::npos) << found->why;
  }
  cv::Mat fence = sheet();  // strokes side by side are none
  for (int i = 0; i < 12; ++i)
    cv::line(fence, {60 + 45 * i, 180}, {60 + 45 * i, 300}, cv::Scalar::all(30), 5, cv::LINE_AA);
  const auto found = contours_in(fence, {});
  ASSERT_TRUE(found) << found.error();
  EXPECT_EQ(found->why.find("dashes"), std::string::npos) << found->why;
}

TEST(Select, ANumberThatIsNoneIsToldWhichThereAre) {
  cv::Mat picture = sheet();
  disc(picture, {180, 240}, 90, 30);
  disc(picture, {460, 240}, 60, 30);
  LoadRequest request;
  request.select = 2;
  const auto found = contours_of(picture, request);
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().find("--select 2: there are the contours 0 to 1"), std::string::npos)
      << found.error();
}

}  // namespace
}  // namespace telekerf::vision
