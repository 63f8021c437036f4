// SPDX-License-Identifier: Apache-2.0
// SVG's viewBox in its viewport.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "common/runtime/vectors.h"

namespace tinyxml2 {
class XMLElement;
}

namespace telekerf::vision {

struct ViewBox {
  Vec2 corner = Vec2::Zero();
  Vec2 size = Vec2::Zero();
};

/// The error is one sentence.
tl::expected<ViewBox, std::string> read_view_box(std::string_view text);

/// Units of a viewport of the given size in a unit of the box, along x and y, as preserveAspectRatio has it.
Vec2 scale_of(const ViewBox& box, const Vec2& size, std::string_view aspect);

/// From the units of the box to a viewport of the given size at the origin, as preserveAspectRatio has it.
Eigen::Affine2d fitted(const ViewBox& box, const Vec2& size, std::string_view aspect);

/// Nothing where the element has none.
tl::expected<std::optional<ViewBox>, std::string> view_box_of(const tinyxml2::XMLElement& e);
/// Its preserveAspectRatio.
std::string_view aspect_of(const tinyxml2::XMLElement& e);

}  // namespace telekerf::vision
