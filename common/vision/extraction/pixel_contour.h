// SPDX-License-Identifier: Apache-2.0
// What is found in a picture: contours in pixels.
#pragma once

#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

/// One contour in pixels: x to the right, y downwards, pixel centres at whole numbers. Closed outlines run
/// anticlockwise as seen in the picture; holes run clockwise.
struct PixelContour {
  std::vector<Vec2> points_px;
  bool closed = true;
  bool hole = false;      ///< the inner boundary of a region
  double width_px = 0.0;  ///< of the stroke; 0 for outlines
  double noise_px = 0.0;  ///< rms of what the last smoothing took away: the quality of the points
};

using Contours = std::vector<PixelContour>;

/// Of the contour's box, its diagonal.
double size_px(const PixelContour& contour);
double length_px(const PixelContour& contour);

/// Low-pass along a contour that leaves its bends as they are (geometry::smooth_keeping_bends), then about
/// one point a pixel. Fills `noise_px`.
void smooth_and_resample(PixelContour& contour, double sigma_px);

}  // namespace telekerf::vision
