// SPDX-License-Identifier: Apache-2.0
// What a person sees at once in a photograph: the things that stand out from its background.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <tl/expected.hpp>

#include "common/vision/segmentation/scene.h"

namespace telekerf::vision {

struct Things {
  cv::Mat mask;     ///< of the scene, CV_8U, 255 on the things that stand out
  int cut_off = 0;  ///< others that touch the picture's border
  int small = 0;    ///< others that are too small beside the largest
};

/// The error is a clause that says why none is sure.
tl::expected<Things, std::string> things_in(const Scene& scene);

/// Nothing but solid things lies on a background of one colour and one light, without a shadow.
bool are_solid(const Scene& scene, const cv::Mat& things);

}  // namespace telekerf::vision
