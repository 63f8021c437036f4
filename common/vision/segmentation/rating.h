// SPDX-License-Identifier: Apache-2.0
// How well a region of a photograph is a thing: by the contrast along its outline.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/vision/segmentation/scene.h"

namespace telekerf::vision {

struct Rating {
  double median = 0.0;    ///< contrast across the outline, units of L*a*b*
  double weak = 0.0;      ///< and what three quarters of the outline surpass
  double texture = 0.0;   ///< the same contrast along the outline's parallels to either side
  double blind = 0.0;     ///< fraction of the outline across which next to nothing changes
  double touching = 0.0;  ///< fraction of the outline along the picture's border
  int sides = 0;          ///< of the picture that the outline touches
  double area = 0.0;      ///< fraction of the picture
  double round = 0.0;     ///< area over that of a disc with the outline's length, 0 to 1

  /// Many small steps, or one long clear one? The larger the better.
  double score() const;
};

/// `outline`: pixels of the scene, as cv::findContours gives them.
Rating rating_of(const Scene& scene, const std::vector<cv::Point>& outline);

/// The outer outlines of a mask (CV_8U), without specks below `min_area_px`.
std::vector<std::vector<cv::Point>> outlines_of_mask(const cv::Mat& mask, double min_area_px);

/// The parts of a mask that hold one of the points, their holes filled.
cv::Mat parts_holding(const cv::Mat& mask, const std::vector<cv::Point>& points);

}  // namespace telekerf::vision
