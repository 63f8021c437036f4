// SPDX-License-Identifier: Apache-2.0
// SVG's transform attribute.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string_view>

namespace telekerf::vision {

/// A transform attribute, from an element's coordinates to those around it; nothing where it cannot be read.
std::optional<Eigen::Affine2d> transform_of(std::string_view text);

}  // namespace telekerf::vision
