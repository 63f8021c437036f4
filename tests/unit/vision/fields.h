// SPDX-License-Identifier: Apache-2.0
// Fields of which every border is known exactly.
#pragma once

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "common/vision/raster/field.h"

namespace telekerf::vision {

/// The field of these grey levels; light drawings on a dark ground.
template <typename Grey>
Field field_of(int cols, int rows, double level, const Grey& grey) {
  Field field;
  field.smooth = cv::Mat(rows, cols, CV_8U);
  field.level = level;
  field.dark = false;
  field.contrast = 200.0;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < cols; ++x)
      field.smooth.at<unsigned char>(y, x) = static_cast<unsigned char>(grey(x, y));
  }
  field.drawn = field.smooth > level;
  return field;
}

/// 200 in the middle, 20 less with each pixel of `distance`, 0 at the least.
inline int slope(int distance) { return std::clamp(200 - 20 * distance, 0, 200); }

}  // namespace telekerf::vision
