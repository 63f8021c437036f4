// SPDX-License-Identifier: Apache-2.0
// What lies round a drawing or over it and is no part of it: the desk round its sheet, hair over a region.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "common/vision/extraction/separation.h"

namespace telekerf::vision {

struct Cleared {
  Separation found;
  std::string what;  ///< a clause: what was left out
  cv::Mat hidden;    ///< CV_8U, 255 where the picture was guessed; empty: nowhere
};

/// The drawing on a light sheet that lies on a darker desk. Nothing when there is no such sheet, nothing
/// drawn on it, or when it could be a plate with holes: what is "drawn" on it looks like the even ground
/// round it.
std::optional<Cleared> on_sheet(const cv::Mat& grey, const tl::expected<Separation, std::string>& first);

/// A region that thin dark lines lie across. Nothing when no line runs both over it and beside it.
std::optional<Cleared> under_hair(const cv::Mat& grey, const tl::expected<Separation, std::string>& first);

/// Where a closed outline runs through what was hidden it is led straight on from both sides.
void lead_through(const cv::Mat& hidden, PixelContour& outline);

}  // namespace telekerf::vision
