// SPDX-License-Identifier: Apache-2.0
// A light sheet on a darker desk: where it lies, and the picture without the desk.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf::vision {

struct Sheet {
  std::vector<cv::Point> outline;  ///< convex, pixels of the picture
  std::vector<Vec2> corners;  ///< four, clockwise as seen from the top left one; empty if one is not seen
  bool askew = false;         ///< no rectangle along the picture's sides, as a drawn plate would be
  double desk_level = 0.0;    ///< median grey level of the desk
  double desk_range = 0.0;    ///< range of four fifths of its levels
  double paper_level = 0.0;   ///< median of the sheet
};

/// The sheet in a CV_8U picture, if one large light convex shape lies on something darker.
std::optional<Sheet> sheet_in(const cv::Mat& grey);

/// The picture as if the sheet went on everywhere: its light, a parabola, beyond its rim.
cv::Mat without_desk(const cv::Mat& grey, const Sheet& sheet);

/// The sheet seen straight from above, `width_px` x `height_px`: `picture` of any kind, `corners` four.
cv::Mat rectified(const cv::Mat& picture, const std::vector<Vec2>& corners, int width_px, int height_px);

}  // namespace telekerf::vision
