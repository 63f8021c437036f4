// SPDX-License-Identifier: Apache-2.0
// The thing that a user points at in a photograph.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "common/vision/segmentation/scene.h"

namespace telekerf::vision {

/// What the user says, pixels of the picture.
struct Pointing {
  std::vector<Vec2> at;                     ///< inside the thing, or one in each of several
  std::vector<Vec2> away;                   ///< outside of it
  std::optional<Eigen::Vector4d> box = {};  ///< x, y, width, height: all of the thing lies within

  bool any() const noexcept { return !at.empty() || box.has_value(); }
};

/// A mask of the scene, CV_8U, 255 on what is pointed at. The error is one sentence.
tl::expected<cv::Mat, std::string> pointed_at(const Scene& scene, const Pointing& pointing);

}  // namespace telekerf::vision
