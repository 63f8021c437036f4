// SPDX-License-Identifier: Apache-2.0
// A picture with the path drawn over it.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/vision/load.h"

namespace telekerf::vision {

/// The picture (or, for a vector drawing, a white page) with all contours and their numbers, the selected one
/// in red, its start in green, its direction as a purple dot some way on.
cv::Mat overlay_of(const LoadedContours& loaded);

}  // namespace telekerf::vision
