// SPDX-License-Identifier: Apache-2.0
#include "common/vision/raster/shadow.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace telekerf::vision {

cv::Mat without_shadows(const cv::Mat& grey, int small_side) {
  // The paper alone, in small: lines are filled up from their sides. Dark ones by a closing, light ones by an
  // opening; the one that takes more away has found the drawing.
  constexpr int kWidestLine = 15;
  const double scale = std::min(1.0, double(small_side) / std::min(grey.cols, grey.rows));
  cv::Mat small;
  cv::resize(grey, small, {}, scale, scale, cv::INTER_AREA);
  const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_ELLIPSE, {kWidestLine, kWidestLine});
  cv::Mat closed;
  cv::Mat opened;
  cv::morphologyEx(small, closed, cv::MORPH_CLOSE, kernel);
  cv::morphologyEx(small, opened, cv::MORPH_OPEN, kernel);
  const bool dark = cv::norm(closed, small, cv::NORM_L2) >= cv::norm(small, opened, cv::NORM_L2);
  cv::Mat paper;
  cv::GaussianBlur(dark ? closed : opened, paper, {}, 2.0);
  cv::resize(paper, paper, grey.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat out;
  if (dark) {
    cv::divide(grey, paper, out, 230.0);  // ink takes its share of whatever light there is
  } else {
    cv::subtract(grey, paper, out);
    cv::add(out, cv::Scalar(25), out);
  }
  return out;
}

}  // namespace telekerf::vision
