// SPDX-License-Identifier: Apache-2.0
// The way of the thesis (3.1.1-3.1.3): an edge band, and a window that travels along it.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "common/vision/extraction/extract.h"
#include "common/vision/extraction/strokes.h"
#include "common/vision/raster/picture.h"

namespace telekerf::vision {

/// Canny's edges, dilated and eroded until they are continuous. For a stroke the kernel is wider than the
/// stroke, so that its two edges become one band. Values are weights: the ink's darkness (strokes) or the
/// edge's strength (regions).
cv::Mat edge_band(const Field& field, double stroke_width_px, bool is_stroke);

/// The first pixel of the band that a square meets which shrinks from the picture's border (closed
/// contours, 3.1.2).
std::optional<cv::Point> first_in_evolving_square(const cv::Mat& band);

/// Follows the band from `start` in both directions. The tangent is the structure tensor's eigenvector of the
/// smallest eigenvalue (eq. 1 has two unknowns and fails on straight edges), its sign kept by t . t_before >=
/// 0; where strokes cross it is undefined and the window goes straight on; where the band ends in a corner,
/// the way there is hidden from the window until it has left. Pixels passed are removed, except from
/// crossings. An empty route is returned when there is nothing to follow.
Route follow_band(const cv::Mat& band, const cv::Point& start, double band_width_px, bool is_stroke);

}  // namespace telekerf::vision
