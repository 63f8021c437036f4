// SPDX-License-Identifier: Apache-2.0
// The edge band of the thesis (3.1.1), and where a closed contour is first met (3.1.2).
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "common/vision/raster/field.h"

namespace telekerf::vision {

/// Weights of a band below this fraction of the largest are background.
inline constexpr float kFaintWeight = 0.08F;

/// Canny's edges, dilated and eroded until they are continuous. For a stroke the kernel is wider than the
/// stroke, so that its two edges become one band. Values are weights: the ink's darkness (strokes) or the
/// edge's strength (regions). `level`: share of the whole contrast that an edge must have, 0.5 for most
/// pictures.
cv::Mat edge_band(const Field& field, double stroke_width_px, bool is_stroke, double level = 0.5);

/// The first pixel of the band that a square meets which shrinks from the picture's border (closed
/// contours, 3.1.2).
std::optional<cv::Point> first_in_evolving_square(const cv::Mat& band);

}  // namespace telekerf::vision
