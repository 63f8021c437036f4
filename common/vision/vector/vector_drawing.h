// SPDX-License-Identifier: Apache-2.0
// Drawings that say their own size: SVG and DXF files -> polylines in metres.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "common/geometry/polyline.h"
#include "common/vision/vector/unsupported_elements.h"

namespace telekerf::vision {

/// Bounds that keep a hostile file from filling memory or time.
struct VectorLimits {
  double chord_error_m = 0.1e-6;  ///< largest distance of a curve from its polyline
  std::size_t most_points = 2'000'000;
  std::size_t most_bytes = 64'000'000;
};

/// Contours in metres, x to the right, y upwards, in the file's own frame; open ends that meet exactly are
/// joined.
struct VectorDrawing {
  std::vector<geometry::Polyline> contours;
  double page_width_m = 0.0;  ///< 0: the file does not say
  double page_height_m = 0.0;
  UnsupportedElements left_out;  ///< text, images, dimensions: what has no line, or none that is understood
};

/// SVG: path, line, polyline, polygon, rect, circle, ellipse; groups, transforms, nested svg, use of what the
/// file itself defines; units of width and height against the viewBox, 96 pixels an inch otherwise. What is
/// not drawn (defs, display none) is no loss; whatever else is not followed is in `left_out`. The error is
/// one sentence.
tl::expected<VectorDrawing, std::string> read_svg(std::string_view text, const VectorLimits& limits = {});

/// DXF (ASCII): LINE, LWPOLYLINE and POLYLINE with bulges, ARC, CIRCLE, ELLIPSE, SPLINE and INSERT of blocks
/// of these, in $INSUNITS, millimetres if unset. Whatever else is not followed is in `left_out`.
tl::expected<VectorDrawing, std::string> read_dxf(std::string_view text, const VectorLimits& limits = {});

/// By the file's extension, .svg or .dxf; every other file is none of these (`is_vector_file` says so).
bool is_vector_file(const std::string& path);
tl::expected<VectorDrawing, std::string> read_vector_file(const std::string& path,
                                                          const VectorLimits& limits = {});

}  // namespace telekerf::vision
