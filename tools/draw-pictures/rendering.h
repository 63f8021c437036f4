// SPDX-License-Identifier: Apache-2.0
// A drawing as a camera would see it.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "tools/draw-pictures/drawing.h"

namespace telekerf::drawing {

/// What the paper and the camera add.
struct Appearance {
  int width_px = 640;
  int height_px = 480;
  double paper = 228.0;  ///< grey level of the background
  double ink = 40.0;     ///< grey level of the drawing
  double blur_px = 0.8;  ///< sigma of the lens
  double noise = 4.0;    ///< sigma in grey levels
  double shading = 0.0;  ///< how much darker the far corner is, grey levels
  double grain = 0.0;    ///< slow unevenness of the paper, grey levels
  std::uint64_t seed = 1;
};

/// One grey picture (CV_8U), anti-aliased by sampling each pixel 6 x 6 times.
cv::Mat render(const Drawing& drawing, const Appearance& appearance);

}  // namespace telekerf::drawing
