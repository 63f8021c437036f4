// SPDX-License-Identifier: Apache-2.0
// Light that changes at once, where a shadow ends, taken out from behind lines.
#pragma once

#include <opencv2/core/mat.hpp>

namespace telekerf::vision {

/// The picture with its slow changes and shadows taken out, as they are behind lines; wide regions go as
/// well. `small_side`: pixels of the picture's shorter side when it is searched for its paper; lines up to 15
/// of these are left whole, and a shadow's edge is known to about two.
cv::Mat without_shadows(const cv::Mat& grey, int small_side);

}  // namespace telekerf::vision
