// SPDX-License-Identifier: Apache-2.0
// Light that changes at once, where a shadow ends: how it is noticed, and taken out from behind lines.
#pragma once

#include "common/vision/raster/field.h"

namespace telekerf::vision {

/// Fraction of the picture's sharp edges that lie on the border between drawing and background, 0 to 1. What
/// was split along a shadow, or not split where it should be, leaves edges unexplained. Looked at in some
/// rows and columns only.
double explained_edges(const Field& field);

/// The same picture split where it explains most edges: a shadow is no drawing where all that is drawn is
/// darker than it.
Field at_explaining_level(const Field& field);

/// The picture with its slow changes and shadows taken out, as they are behind lines; wide regions go as
/// well. `small_side`: pixels of the picture's shorter side when it is searched for its paper; lines up to 15
/// of these are left whole, and a shadow's edge is known to about two.
cv::Mat without_shadows(const cv::Mat& grey, int small_side);

}  // namespace telekerf::vision
