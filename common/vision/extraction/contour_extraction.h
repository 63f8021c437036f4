// SPDX-License-Identifier: Apache-2.0
// The ways from a separated picture to contours; extract.h chooses among them.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "common/vision/extraction/extract.h"
#include "common/vision/raster/picture.h"

namespace telekerf::vision {

using Contours = std::vector<PixelContour>;

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
};
Outlines outlines_of(const Field& field);

/// Centre lines of everything drawn, one pass each, crossings straight on; unsorted and unsmoothed.
Contours strokes_of(const Field& field, const Outlines& outlines);

/// Moves a closed border, points about one pixel apart, to where the picture is half way between drawing and
/// background *here*: uneven light shifts a border of one level by a part of its blur.
void move_to_local_level(const Field& field, double blur_px, std::vector<Vec2>& points);

/// Low-pass along a contour that leaves its bends as they are (geometry::smooth_keeping_bends), then about one
/// point a pixel. Fills `noise_px`.
void smooth_and_resample(PixelContour& contour, double sigma_px);

}  // namespace telekerf::vision
