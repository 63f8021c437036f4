// SPDX-License-Identifier: Apache-2.0
// An SVG file's elements -> lines.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "common/vision/vector/vector_drawing.h"

namespace telekerf::vision {

/// SVG: path, line, polyline, polygon, rect, circle, ellipse; groups, transforms, nested svg, use of what the
/// file itself defines; units of width and height against the viewBox, 96 pixels an inch otherwise. What is
/// not drawn (defs, display none) is no loss; whatever else is not followed is in `unsupported`. The error is
/// one sentence.
tl::expected<VectorDrawing, std::string> read_svg(std::string_view text, const VectorLimits& limits = {});

}  // namespace telekerf::vision
