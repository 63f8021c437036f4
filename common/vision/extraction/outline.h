// SPDX-License-Identifier: Apache-2.0
// The borders of what is drawn.
#pragma once

#include <vector>

#include "common/vision/extraction/pixel_contour.h"
#include "common/vision/raster/field.h"

namespace telekerf::vision {

/// Boundaries between drawing and background by marching squares: closed, sub-pixel, in drawing order,
/// unsorted. Regions that touch the picture's border are left out and counted in `cut_off`, as their outline
/// is not whole.
struct Outlines {
  Contours contours;
  std::vector<double> areas_px;  ///< of each contour; negative: a hole
  int cut_off = 0;
  /// Twice the area over the perimeter of everything drawn: the width of a stroke, or about a third of a
  /// region's.
  double width_px = 0.0;
  double size_px = 0.0;  ///< diagonal of the largest shape's box

  /// What is drawn is a stroke, not a region: thinner than this fraction of its size.
  static constexpr double kThin = 0.075;
  bool thin() const noexcept { return width_px < kThin * size_px; }
};
Outlines outlines_of(const Field& field);

/// Fills `areas_px`'s companions, `width_px` and `size_px`, after contours were taken out or put in.
void measure(Outlines& part);

/// The drawn pixel on whose western side the walk round a contour began.
cv::Point seed_of(const PixelContour& contour);

}  // namespace telekerf::vision
