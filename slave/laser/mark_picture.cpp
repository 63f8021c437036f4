// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/mark_picture.h"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace telekerf::laser {

cv::Mat mark_picture(const cv::Mat& burnt, const Material& material) {
  cv::Mat out(burnt.size(), CV_8UC3);
  for (int r = 0; r < out.rows; ++r) {
    for (int c = 0; c < out.cols; ++c) {
      const double share = burnt.at<float>(r, c);
      // Grain: a slow ripple, enough to tell wood from paper.
      const double grain = 8.0 * std::sin(0.045 * c + 1.4 * std::sin(0.006 * r + 0.002 * c));
      for (int k = 0; k < 3; ++k) {
        out.at<cv::Vec3b>(r, c)[k] = cv::saturate_cast<std::uint8_t>(
            (1.0 - share) * (material.paper_bgr[k] + grain) + share * material.burnt_bgr[k]);
      }
    }
  }
  return out;
}

void draw_scale_bar(cv::Mat& picture, double pixel_m, const cv::Scalar& colour_bgr) {
  const double most_mm = picture.cols * pixel_m * 1e3 / 4.0;
  const double decade = std::pow(10.0, std::floor(std::log10(most_mm)));
  const double length_mm = decade * (most_mm >= 5.0 * decade ? 5.0 : most_mm >= 2.0 * decade ? 2.0 : 1.0);
  const cv::Point from(40, picture.rows - 25);
  const cv::Point way(static_cast<int>(std::lround(length_mm * 1e-3 / pixel_m)), 0);
  cv::line(picture, from, from + way, colour_bgr, 3, cv::LINE_AA);
  cv::putText(picture, fmt::format("{:g} mm", length_mm), from + cv::Point(0, -12), cv::FONT_HERSHEY_SIMPLEX,
              0.7, colour_bgr, 2, cv::LINE_AA);
}

}  // namespace telekerf::laser
