// SPDX-License-Identifier: Apache-2.0
// A region found in small -> its outline in the whole picture, finer than a pixel.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/vision/extraction/pixel_contour.h"
#include "common/vision/segmentation/scene.h"

namespace telekerf::vision {

/// The outlines of a mask of the scene, moved to where the picture (`bgr`, CV_8UC3) changes most across them.
/// Closed, anticlockwise as seen, unsorted; along the picture's border they follow it.
Contours snapped_outlines(const Scene& scene, const cv::Mat& mask, const cv::Mat& bgr);

}  // namespace telekerf::vision
