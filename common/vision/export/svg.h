// SPDX-License-Identifier: Apache-2.0
// Contours as an SVG file.
#pragma once

#include <span>
#include <string>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

/// True-size SVG in millimetres, y turned down again.
std::string to_svg(std::span<const geometry::Polyline> contours);

}  // namespace telekerf::vision
