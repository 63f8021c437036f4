// SPDX-License-Identifier: Apache-2.0
// Borders in uneven light.
#pragma once

#include <vector>

#include "common/vision/raster/field.h"

namespace telekerf::vision {

/// Moves a closed border, points about one pixel apart, to where the picture is half way between drawing and
/// background *here*: uneven light shifts a border of one level by a part of its blur.
void move_to_local_level(const Field& field, double blur_px, std::vector<Vec2>& points);

}  // namespace telekerf::vision
