// SPDX-License-Identifier: Apache-2.0
// Light that changes slowly over the background: how it is found, and taken out.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

namespace telekerf::vision {

/// Grey level of the background, factors of 1, u, v, u u, u v, v v; u and v run from -0.5 to 0.5 over the
/// picture's width and height.
using Light = Eigen::Matrix<double, 6, 1>;

/// A parabola in x and y through the picture's block medians, fitted again and again without the blocks that
/// lie off it. Nothing when the background is not the larger part of the picture. `noise`: the picture's,
/// grey levels.
std::optional<Light> light_of(const cv::Mat& grey, double noise);

/// How far the light can differ from its middle's, grey levels.
double change_of(const Light& light);

/// The picture minus the light's change, in whole grey levels: bytes stay bytes.
cv::Mat flattened(const cv::Mat& picture, const Light& light);

}  // namespace telekerf::vision
