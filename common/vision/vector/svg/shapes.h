// SPDX-License-Identifier: Apache-2.0
// The shapes and paths of SVG -> lines.
#pragma once

#include <Eigen/Geometry>
#include <string_view>

#include "common/vision/vector/drawn_lines.h"
#include "common/vision/vector/svg/lengths.h"

namespace telekerf::vision {

/// Draws path, line, polyline, polygon, rect, circle or ellipse; false: `name` is none of these.
/// `here` places the element's coordinates in the drawing.
bool draw_shape(std::string_view name, const tinyxml2::XMLElement& e, const Properties& own,
                const SvgCoordinates& at, const Eigen::Affine2d& here, DrawnLines& out);

}  // namespace telekerf::vision
