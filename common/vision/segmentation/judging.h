// SPDX-License-Identifier: Apache-2.0
// Whether a region that was found where somebody points is a thing, or a piece of background or texture.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/vision/segmentation/scene.h"

namespace telekerf::vision {

/// Why a region is no thing, a clause; nullptr: it is one. `mask`: CV_8U of the scene. In texture there is
/// always some line to follow: the bounds are those that set apart what people would trace from what they
/// would not, in photographs and textures that were looked at by eye.
const char* why_no_thing(const Scene& scene, const cv::Mat& mask);

}  // namespace telekerf::vision
