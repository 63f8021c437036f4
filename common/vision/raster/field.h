// SPDX-License-Identifier: Apache-2.0
// A grey plane -> a field whose sign tells drawing from background.
#pragma once

#include <cmath>
#include <opencv2/core/mat.hpp>
#include <string>
#include <tl/expected.hpp>

#include "common/runtime/vectors.h"

namespace telekerf::vision {

/// The picture as a field: positive on the drawing, negative on the background, zero on the border between.
struct Field {
  cv::Mat smooth;         ///< CV_8U, Gaussian filtered
  cv::Mat drawn;          ///< CV_8U, 255 where the value is positive
  double level = 0.0;     ///< half way between drawing and background, unless another share is asked for
  bool dark = true;       ///< the drawing is darker than its background
  double contrast = 0.0;  ///< grey levels between drawing and background
  double noise = 0.0;     ///< standard deviation of the picture's noise, grey levels, before smoothing
  double sigma_px = 1.0;  ///< of the Gaussian

  double value(int x, int y) const noexcept {
    const double v = smooth.at<unsigned char>(y, x) - level;
    return dark ? -v : v;
  }

  /// Between pixels, bilinear; -1, background, beyond the picture.
  double value(const Vec2& p) const noexcept {
    const int x = static_cast<int>(std::floor(p.x()));
    const int y = static_cast<int>(std::floor(p.y()));
    if (x < 0 || y < 0 || x + 1 >= smooth.cols || y + 1 >= smooth.rows) return -1.0;
    const double u = p.x() - x;
    const double v = p.y() - y;
    const auto* upper = smooth.ptr<unsigned char>(y) + x;
    const auto* lower = smooth.ptr<unsigned char>(y + 1) + x;
    const double grey =
        (1 - v) * (upper[0] + u * (upper[1] - upper[0])) + v * (lower[0] + u * (lower[1] - lower[0]));
    return dark ? level - grey : grey - level;
  }
};

/// Standard deviation of the noise from the median of second differences, which edges hardly touch.
double noise_of(const cv::Mat& grey);
/// Most of the picture's border, which is background, is darker than `level`.
bool border_is_dark(const cv::Mat& smooth, double level);
/// Smooths and separates; the error says why the picture holds no drawing.
tl::expected<Field, std::string> make_field(const cv::Mat& grey);

/// The same picture with the border at that share of the way from background to drawing; 0.5 is half way.
Field at_share(const Field& field, double share);

/// Drawing and background swapped.
Field inverted(const Field& field);

}  // namespace telekerf::vision
