// SPDX-License-Identifier: Apache-2.0
// Any picture -> its contours: a drawing's lines and regions, or the outlines of the things in a photograph.
#pragma once

#include "common/vision/extraction/contour_extraction.h"
#include "common/vision/segmentation/pointed.h"

namespace telekerf::vision {

struct PictureRequest {
  ExtractionSettings extraction;
  Pointing pointing;
};

/// A drawing on a background is extracted as such. What is none is looked at as a photograph: the things that
/// stand out from its background, or what `pointing` says. The error is one sentence with its remedy.
tl::expected<Extraction, std::string> contours_in(const cv::Mat& image, const PictureRequest& request);

}  // namespace telekerf::vision
