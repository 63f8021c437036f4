// SPDX-License-Identifier: Apache-2.0
// Any picture -> one plane of 8 bits.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <tl/expected.hpp>

namespace telekerf::vision {

/// One 8-bit plane of a picture of any depth with 1, 3 or 4 channels: its brightness, or the distance from
/// the background's colour where that tells more; alpha is laid over white. The error is one sentence.
tl::expected<cv::Mat, std::string> grey_plane(const cv::Mat& image);

/// The same picture in colour, CV_8UC3, alpha laid over white; empty where grey_plane() fails.
cv::Mat colour_plane(const cv::Mat& image);

}  // namespace telekerf::vision
