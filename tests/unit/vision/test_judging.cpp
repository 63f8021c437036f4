// SPDX-License-Identifier: Apache-2.0
// A region is a thing when it differs from what lies round it. Patches of texture, patterns and what is left
// of a picture without its things are none, however clear a line runs round them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "common/vision/segmentation/judging.h"
#include "common/vision/segmentation/pointed.h"
#include "common/vision/segmentation/rating.h"
#include "common/vision/segmentation/sides.h"

namespace telekerf::vision {
namespace {

constexpr int kWidth = 240;
constexpr int kHeight = 180;
const cv::Point kMiddle(120, 90);
constexpr int kRadius = 45;

/// Patches of about `patch_px` in greys round 110.
cv::Mat texture(double patch_px, double contrast, std::uint64_t seed) {
  cv::RNG rng(seed);
  cv::Mat plane(kHeight, kWidth, CV_32F);
  rng.fill(plane, cv::RNG::NORMAL, 0.0, 1.0);
  if (patch_px > 0.0) cv::GaussianBlur(plane, plane, {}, patch_px);
  cv::Scalar mean;
  cv::Scalar spread;
  cv::meanStdDev(plane, mean, spread);
  plane = (plane - mean[0]) * (contrast / spread[0]) + 110.0;
  cv::Mat grey;
  plane.convertTo(grey, CV_8U);
  cv::Mat out;
  cv::cvtColor(grey, out, cv::COLOR_GRAY2BGR);
  return out;
}

cv::Mat disc_mask() {
  cv::Mat out(kHeight, kWidth, CV_8U, cv::Scalar(0));
  cv::circle(out, kMiddle, kRadius, cv::Scalar(255), cv::FILLED);
  return out;
}

double unseparated_of(const cv::Mat& picture, const cv::Mat& mask) {
  return unseparated(scene_of(picture, kWidth), mask, outlines_of_mask(mask, 12.0).front());
}

std::string verdict(const cv::Mat& picture, const cv::Mat& mask) {
  const char* why = why_no_thing(scene_of(picture, kWidth), mask);
  return why == nullptr ? "a thing" : why;
}

cv::Mat checker(int square_px) {
  cv::Mat out(kHeight, kWidth, CV_8UC3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool dark = (x / square_px + y / square_px) % 2 == 0;
      out.at<cv::Vec3b>(y, x) = dark ? cv::Vec3b(60, 60, 60) : cv::Vec3b(200, 200, 200);
    }
  }
  return out;
}

TEST(Judging, AThingOnTextureIsAThingAndTheSamePatchOfTextureIsNone) {
  for (const double patch_px : {1.0, 2.0, 4.0}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(testing::Message() << "patches of " << patch_px << " px, seed " << seed);
      cv::Mat picture = texture(patch_px, 25.0, seed);
      EXPECT_NE(verdict(picture, disc_mask()), "a thing");
      EXPECT_GT(unseparated_of(picture, disc_mask()), 0.5);
      cv::circle(picture, kMiddle, kRadius, cv::Scalar(40, 60, 220), cv::FILLED);
      EXPECT_EQ(verdict(picture, disc_mask()), "a thing");
      EXPECT_LT(unseparated_of(picture, disc_mask()), 0.02);
    }
  }
}

TEST(Judging, WhatOfAnOutlineSeparatesNothingIsMeasuredAlongIt) {
  // The left half of the disc is there; the right half of its outline runs through nothing.
  cv::Mat picture(kHeight, kWidth, CV_8UC3, cv::Scalar(110, 110, 110));
  cv::ellipse(picture, kMiddle, {kRadius, kRadius}, 0.0, 90.0, 270.0, cv::Scalar(40, 60, 220), cv::FILLED);
  EXPECT_NEAR(unseparated_of(picture, disc_mask()), 0.5, 0.08);
  EXPECT_NE(verdict(picture, disc_mask()), "a thing");
}

TEST(Judging, LikenessIsOneForMoreOfTheSameAndNothingForAnotherColour) {
  cv::Mat picture = texture(1.5, 25.0, 7);
  EXPECT_GT(likeness_to_ring(scene_of(picture, kWidth), disc_mask()), 0.95);
  cv::circle(picture, kMiddle, kRadius, cv::Scalar(40, 60, 220), cv::FILLED);
  EXPECT_LT(likeness_to_ring(scene_of(picture, kWidth), disc_mask()), 0.05);
  // Nothing lies round what fills the picture.
  EXPECT_EQ(likeness_to_ring(scene_of(picture, kWidth), cv::Mat(kHeight, kWidth, CV_8U, cv::Scalar(255))),
            0.0);
}

TEST(Judging, APartOfAPatternIsNoThingAndOneOfItsSquaresIs) {
  constexpr int kSquare = 20;
  const cv::Mat picture = checker(kSquare);
  cv::Mat part(kHeight, kWidth, CV_8U, cv::Scalar(0));
  part(cv::Rect(3 * kSquare, 2 * kSquare, 6 * kSquare, 5 * kSquare)).setTo(255);
  EXPECT_NE(verdict(picture, part).find("more of the same"), std::string::npos) << verdict(picture, part);
  cv::Mat square(kHeight, kWidth, CV_8U, cv::Scalar(0));
  square(cv::Rect(5 * kSquare, 4 * kSquare, kSquare, kSquare)).setTo(255);
  EXPECT_EQ(verdict(picture, square), "a thing");
}

TEST(Judging, WhatIsLeftOfThePictureWithoutItsThingsIsBackground) {
  // A light field with bays on all sides, in a frame of which a part has its colour.
  cv::Mat picture(kHeight, kWidth, CV_8UC3, cv::Scalar(60, 90, 60));
  cv::Mat mask(kHeight, kWidth, CV_8U, cv::Scalar(0));
  mask(cv::Rect(10, 10, kWidth - 20, kHeight - 20)).setTo(255);
  for (int i = 0; i < 3; ++i) {
    for (const int side : {10, 130}) mask(cv::Rect(40 + 65 * i, side, 14, 40)).setTo(0);
  }
  picture.setTo(cv::Scalar(200, 200, 200), mask);
  EXPECT_EQ(verdict(picture, mask), "a thing");  // all round it lies another colour
  picture(cv::Rect(0, 0, kWidth, 6)).setTo(cv::Scalar(200, 200, 200));
  EXPECT_NE(verdict(picture, mask).find("looks like the background"), std::string::npos)
      << verdict(picture, mask);
}

TEST(Judging, LongAndThinIsAThingAndAWindingLineRoundNothingIsNone) {
  cv::Mat picture(kHeight, kWidth, CV_8UC3, cv::Scalar(110, 110, 110));
  cv::Mat bar(kHeight, kWidth, CV_8U, cv::Scalar(0));
  bar(cv::Rect(15, 80, 210, 9)).setTo(255);
  picture.setTo(cv::Scalar(220, 220, 220), bar);
  EXPECT_LT(rating_of(scene_of(picture, kWidth), outlines_of_mask(bar, 12.0).front()).round, 0.15);
  EXPECT_EQ(verdict(picture, bar), "a thing");
  // As much of an outline for its area, to and fro.
  picture.setTo(cv::Scalar(110, 110, 110));
  cv::Mat comb(kHeight, kWidth, CV_8U, cv::Scalar(0));
  comb(cv::Rect(60, 40, 120, 20)).setTo(255);
  for (int i = 0; i < 5; ++i) comb(cv::Rect(60 + 26 * i, 40, 15, 62)).setTo(255);
  picture.setTo(cv::Scalar(220, 220, 220), comb);
  const double round = rating_of(scene_of(picture, kWidth), outlines_of_mask(comb, 12.0).front()).round;
  EXPECT_GT(round, 0.1);
  EXPECT_LT(round, 0.15);
  EXPECT_NE(verdict(picture, comb), "a thing");
}

TEST(Judging, WhoPointsIntoAPatternOrTextureIsToldWhatToDo) {
  for (const cv::Mat& picture : {checker(20), texture(3.0, 30.0, 5)}) {
    Pointing pointing;
    pointing.at = {Vec2(100.0, 75.0)};
    const auto found = pointed_at(scene_of(picture, kWidth), pointing);
    ASSERT_FALSE(found);
    EXPECT_NE(found.error().find("--box X,Y,WIDTH,HEIGHT"), std::string::npos) << found.error();
    EXPECT_NE(found.error().find("--not"), std::string::npos) << found.error();
  }
}

}  // namespace
}  // namespace telekerf::vision
