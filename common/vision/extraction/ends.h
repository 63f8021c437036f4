// SPDX-License-Identifier: Apache-2.0
// Where a path starts and ends, as its user wants it.
#pragma once

#include <optional>

#include "common/vision/extraction/pixel_contour.h"

namespace telekerf::vision {

/// The part between two points of a contour; without `end` only the start moves. An end that is nearly meant
/// is kept whole. The contour that lies nearest comes first.
void apply_ends(Contours& contours, const std::optional<Vec2>& start, const std::optional<Vec2>& end);

}  // namespace telekerf::vision
