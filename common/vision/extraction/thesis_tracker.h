// SPDX-License-Identifier: Apache-2.0
// The window of the thesis that travels along an edge band (3.1.3).
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/vision/extraction/routes.h"

namespace telekerf::vision {

/// Follows the band from `start` in both directions. The tangent is the structure tensor's eigenvector of the
/// smallest eigenvalue (eq. 1 has two unknowns and fails on straight edges), its sign kept by t . t_before >=
/// 0; where strokes cross it is undefined and the window goes straight on; where the band ends in a corner,
/// the way there is hidden from the window until it has left. Pixels passed are removed, except from
/// crossings. An empty route is returned when there is nothing to follow.
Route follow_band(const cv::Mat& band, const cv::Point& start, double band_width_px, bool is_stroke);

}  // namespace telekerf::vision
