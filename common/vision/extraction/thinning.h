// SPDX-License-Identifier: Apache-2.0
// A thick drawing reduced to lines of one pixel.
#pragma once

#include <opencv2/core/mat.hpp>

namespace telekerf::vision {

/// Guo and Hall's parallel thinning, 64 pixels at a time and only where something still changes. CV_8U, 0 and
/// 255.
cv::Mat thinned(const cv::Mat& drawn);

}  // namespace telekerf::vision
