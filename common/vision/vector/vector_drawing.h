// SPDX-License-Identifier: Apache-2.0
// A drawing that says its own size: what the readers of SVG and DXF give.
#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/polyline.h"
#include "common/vision/vector/unsupported_elements.h"

namespace telekerf::vision {

/// Bounds that keep a hostile file from filling memory or time.
struct VectorLimits {
  double chord_error_m = 0.1e-6;  ///< largest distance of a curve from its polyline
  std::size_t max_points = 2'000'000;
  std::size_t max_bytes = 64'000'000;
};

/// Contours in metres, x to the right, y upwards, in the file's own frame; open ends that meet exactly are
/// joined.
struct VectorDrawing {
  std::vector<geometry::Polyline> contours;
  double page_width_m = 0.0;  ///< 0: the file does not say
  double page_height_m = 0.0;
  UnsupportedElements
      unsupported;  ///< text, images, dimensions: what has no line, or none that is understood
};

}  // namespace telekerf::vision
