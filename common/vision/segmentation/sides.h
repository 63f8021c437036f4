// SPDX-License-Identifier: Apache-2.0
// Whether a region differs from what lies round it. In texture every line follows some edge; what tells a
// thing from a patch of texture is that its two sides differ over more than a pixel or two.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/vision/segmentation/scene.h"

namespace telekerf::vision {

/// Fraction (0 to 1) of an outline along which the mean colours of its two sides differ by less than the
/// colours within a side do. `mask`: CV_8U of the scene, `outline`: of the mask, pixels, as cv::findContours
/// gives it. Stretches along the picture's border, and those too thin to have two sides, do not count.
double unseparated(const Scene& scene, const cv::Mat& mask, const std::vector<cv::Point>& outline);

/// How alike the colours within a mask and in the ring round it are, 0 to 1: the sum over a histogram of
/// L*a*b* of the geometric means of the two (Bhattacharyya's coefficient). The ring is half as wide as a
/// square of the mask's area. 0 where nothing lies round it.
double likeness_to_ring(const Scene& scene, const cv::Mat& mask);

}  // namespace telekerf::vision
