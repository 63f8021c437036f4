// SPDX-License-Identifier: Apache-2.0
// Thinning by words of 64 pixels against Guo and Hall's, pixel by pixel.
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/vision/extraction/thinning.h"

namespace telekerf::vision {
namespace {

/// Guo and Hall as their paper states it, pixel by pixel, over the whole picture until nothing goes.
cv::Mat thinned_slowly(const cv::Mat& drawn) {
  cv::Mat image = drawn.clone();
  const auto at = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < image.cols && y < image.rows && image.at<unsigned char>(y, x) != 0;
  };
  for (int idle = 0, step = 0; idle < 2; ++step) {
    std::vector<cv::Point> gone;
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        if (!at(x, y)) continue;
        const bool p2 = at(x, y - 1), p3 = at(x + 1, y - 1), p4 = at(x + 1, y), p5 = at(x + 1, y + 1);
        const bool p6 = at(x, y + 1), p7 = at(x - 1, y + 1), p8 = at(x - 1, y), p9 = at(x - 1, y - 1);
        const int c = (!p2 && (p3 || p4)) + (!p4 && (p5 || p6)) + (!p6 && (p7 || p8)) + (!p8 && (p9 || p2));
        const int n = std::min((p9 || p2) + (p3 || p4) + (p5 || p6) + (p7 || p8),
                               (p2 || p3) + (p4 || p5) + (p6 || p7) + (p8 || p9));
        const bool side = step % 2 == 0 ? (p6 || p7 || !p9) && p8 : (p2 || p3 || !p5) && p4;
        if (c == 1 && (n == 2 || n == 3) && !side) gone.emplace_back(x, y);
      }
    }
    for (const cv::Point& p : gone) image.at<unsigned char>(p) = 0;
    idle = gone.empty() ? idle + 1 : 0;
  }
  return image;
}

TEST(Thinning, IsGuoAndHallsOnAnyPicture) {
  cv::RNG rng(7);
  for (const cv::Size size : {cv::Size(8, 9), cv::Size(63, 40), cv::Size(64, 40), cv::Size(131, 97)}) {
    for (const double blur : {0.5, 1.5, 3.0, 6.0}) {
      cv::Mat noise(size, CV_8U);
      rng.fill(noise, cv::RNG::UNIFORM, 0, 256);
      cv::GaussianBlur(noise, noise, {}, blur);
      const cv::Mat drawn = noise > cv::mean(noise)[0];
      EXPECT_EQ(cv::countNonZero(thinned(drawn) != thinned_slowly(drawn)), 0) << size << ", blur " << blur;
    }
  }
}

}  // namespace
}  // namespace telekerf::vision
