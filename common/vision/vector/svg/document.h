// SPDX-License-Identifier: Apache-2.0
// An SVG file's elements -> lines.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "common/vision/vector/vector_drawing.h"

namespace telekerf::vision {

/// SVG: path, line, polyline, polygon, rect, circle, ellipse; groups, transforms, nested svg, use of what the
/// file itself defines; style sheets; units of width and height against the viewBox, 96 pixels an inch
/// otherwise or what the program used that wrote the file. What is not shown is in `left_out`; whatever else
/// is not followed is in `unsupported`, or refused where it would draw in a wrong place. The error is one
/// sentence.
tl::expected<VectorDrawing, std::string> read_svg(std::string_view text, const VectorLimits& limits = {},
                                                  const VectorRequest& request = {});

}  // namespace telekerf::vision
