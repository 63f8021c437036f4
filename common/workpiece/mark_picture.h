// SPDX-License-Identifier: Apache-2.0
// How a workpiece that the beam has marked looks, and the scale drawn on it.
#pragma once

#include <opencv2/core.hpp>

#include "common/workpiece/workpiece.h"

namespace telekerf::workpiece {

/// How dark a mark looks (CV_32F, 0..1): 1 - exp(-3 value / dark) of a raster whose `dark` looks fully burnt.
cv::Mat burnt_fraction(const cv::Mat& raster, double dark);

/// The material's colours by the burnt fraction of each pixel (CV_32F, 0..1), with a little grain; CV_8UC3.
cv::Mat mark_picture(const cv::Mat& burnt, const Material& material);

/// What ink on that material looks like: its burnt colour.
inline cv::Scalar ink_of(const Material& material) {
  return {double(material.burnt_bgr[0]), double(material.burnt_bgr[1]), double(material.burnt_bgr[2])};
}

/// A bar of 1, 2 or 5 times a power of ten millimetres and its length, at the lower left; at most a quarter
/// of the picture's width. `pixel_m`: size of one of the picture's pixels.
void draw_scale_bar(cv::Mat& picture, double pixel_m, const cv::Scalar& colour_bgr);

/// What was dug, as it looks (CV_8UC3), and as a map of colours with the colours' scale beside it; both at
/// most `pixels` wide (without that scale), with a bar of some millimetres below.
cv::Mat picture_of(const Workpiece& workpiece, int pixels = 1200);
cv::Mat depth_picture(const Workpiece& workpiece, int pixels = 1200);

}  // namespace telekerf::workpiece
