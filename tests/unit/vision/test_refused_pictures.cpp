// SPDX-License-Identifier: Apache-2.0
// Pictures that hold no drawing, or not the whole of it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "common/vision/extraction/contour_extraction.h"

namespace telekerf::vision {
namespace {

std::string complaint(const cv::Mat& picture, ExtractionMode mode = ExtractionMode::kAuto) {
  const auto found = extract(picture, {.mode = mode});
  if (found) {
    EXPECT_FALSE(found->contours.empty());
    return "";
  }
  return found.error();
}

TEST(Extract, WhatIsNoDrawingIsRefusedWithAReason) {
  EXPECT_NE(complaint(cv::Mat()).find("empty"), std::string::npos);
  EXPECT_NE(complaint(cv::Mat(1, 1, CV_8U, cv::Scalar(7))).find("1 x 1"), std::string::npos);
  EXPECT_NE(complaint(cv::Mat(400, 600, CV_8UC3, cv::Scalar(90, 90, 90))).find("uniform"), std::string::npos);
  EXPECT_NE(complaint(cv::Mat(400, 600, CV_8UC2, cv::Scalar(90, 90))).find("channels"), std::string::npos);
  cv::RNG rng(1);
  for (const double sigma : {4.0, 20.0, 60.0}) {
    cv::Mat noise(480, 640, CV_8U);
    rng.fill(noise, cv::RNG::NORMAL, 128.0, sigma);
    EXPECT_NE(complaint(noise), "") << sigma;
    EXPECT_NE(complaint(noise, ExtractionMode::kThesis), "") << sigma;
    EXPECT_NE(complaint(noise, ExtractionMode::kStroke), "") << sigma;
  }
  cv::Mat uniform_noise(480, 640, CV_8U);
  rng.fill(uniform_noise, cv::RNG::UNIFORM, 0, 256);
  EXPECT_NE(complaint(uniform_noise), "");
  cv::Mat blurred = uniform_noise.clone();
  cv::GaussianBlur(blurred, blurred, {}, 1.0);
  EXPECT_NE(complaint(blurred).find("specks"), std::string::npos);
  cv::Mat ramp(480, 640, CV_8U);
  for (int x = 0; x < 640; ++x) {
    const int grey = x * 255 / 640;
    ramp.col(x) = grey;
  }
  EXPECT_NE(complaint(ramp), "");
  cv::Mat cut(480, 640, CV_8U, cv::Scalar(220));
  cv::circle(cut, {600, 240}, 150, cv::Scalar(40), -1);
  EXPECT_NE(complaint(cut).find("border"), std::string::npos);
  cv::Mat nan(100, 100, CV_32F, cv::Scalar(NAN));
  EXPECT_NE(complaint(nan), "");
}

TEST(Extract, NoiseOfAnyGrainIsNoDrawing) {
  int pictures = 0;
  int taken = 0;
  std::string which;
  for (const cv::Size size : {cv::Size(160, 120), cv::Size(320, 240), cv::Size(640, 480)}) {
    for (const double blur : {0.7, 1.0, 1.5, 2.5, 4.0, 7.0}) {
      for (const double share : {0.02, 0.1, 0.5}) {
        for (const bool in_alpha : {false, true}) {
          cv::RNG rng(static_cast<std::uint64_t>(size.width + 10.0 * blur + 1000.0 * share));
          cv::Mat noise(size, CV_8U);
          rng.fill(noise, cv::RNG::UNIFORM, 0, 256);
          noise = noise < 256.0 * share;
          cv::GaussianBlur(noise, noise, {}, blur);
          cv::Mat picture = noise;
          if (in_alpha) {
            picture = cv::Mat(size, CV_8UC4, cv::Scalar(0, 0, 0, 0));
            cv::insertChannel(noise, picture, 3);
          }
          ++pictures;
          if (!extract(picture)) continue;
          ++taken;
          which += fmt::format("{} px, blur {}, share {}\n", size.width, blur, share);
        }
      }
    }
  }
  EXPECT_LE(taken, pictures / 50) << which;
}

TEST(Extract, StrokesThatRunOffThePictureAreRefused) {
  cv::Mat cut(480, 640, CV_8U, cv::Scalar(220));
  cv::line(cut, {-10, 200}, {660, 260}, cv::Scalar(40), 6, cv::LINE_AA);
  EXPECT_NE(complaint(cut).find("border"), std::string::npos);
  EXPECT_NE(complaint(cut, ExtractionMode::kStroke).find("border"), std::string::npos);
  // A loop whose tail runs off the picture: its inside is no contour of its own.
  cv::Mat loop(480, 640, CV_8U, cv::Scalar(220));
  cv::circle(loop, {300, 240}, 120, cv::Scalar(40), 6, cv::LINE_AA);
  cv::line(loop, {420, 240}, {660, 240}, cv::Scalar(40), 6, cv::LINE_AA);
  for (const ExtractionMode mode :
       {ExtractionMode::kAuto, ExtractionMode::kOutline, ExtractionMode::kStroke, ExtractionMode::kThesis}) {
    EXPECT_NE(complaint(loop, mode).find("border"), std::string::npos) << kExtractionModes.word(mode);
  }
}

}  // namespace
}  // namespace telekerf::vision
