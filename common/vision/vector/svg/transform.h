// SPDX-License-Identifier: Apache-2.0
// SVG's transforms, as attributes or in a style.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string_view>

#include "common/runtime/vectors.h"

namespace telekerf::vision {

/// A transform attribute, from an element's coordinates to those around it; nothing where it cannot be read.
std::optional<Eigen::Affine2d> transform_of(std::string_view text);

/// A transform-origin: user units, per cents of the viewport, or words like "center"; nothing where it cannot
/// be read.
std::optional<Vec2> origin_of(std::string_view text, const Vec2& viewport);

}  // namespace telekerf::vision
