// SPDX-License-Identifier: Apache-2.0
// Any picture -> one smooth grey plane with a level that separates drawing from background.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <tl/expected.hpp>

namespace telekerf::vision {

/// The picture as a field: positive on the drawing, negative on the background, zero on the border between.
struct Field {
  cv::Mat smooth;         ///< CV_8U, Gaussian filtered
  cv::Mat drawn;          ///< CV_8U, 255 where the value is positive
  double level = 0.0;     ///< half way between drawing and background
  bool dark = true;       ///< the drawing is darker than its background
  double contrast = 0.0;  ///< grey levels between drawing and background
  double noise = 0.0;     ///< standard deviation of the picture's noise, grey levels, before smoothing
  double sigma_px = 1.0;  ///< of the Gaussian

  double value(int x, int y) const noexcept {
    const double v = smooth.at<unsigned char>(y, x) - level;
    return dark ? -v : v;
  }
};

/// One 8-bit plane of a picture of any depth; alpha is laid over white.
tl::expected<cv::Mat, std::string> grey_plane(const cv::Mat& image);
/// Standard deviation of the noise from the median of second differences, which edges hardly touch.
double noise_of(const cv::Mat& grey);
/// Most of the picture's border, which is background, is darker than `level`.
bool border_is_dark(const cv::Mat& smooth, double level);
/// Smooths and separates; the error says why the picture holds no drawing.
tl::expected<Field, std::string> make_field(const cv::Mat& grey);

/// Drawing and background swapped.
Field inverted(const Field& field);

}  // namespace telekerf::vision
