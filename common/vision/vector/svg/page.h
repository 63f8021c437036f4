// SPDX-License-Identifier: Apache-2.0
// The size of an SVG drawing, and of its unit.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "common/runtime/vectors.h"
#include "common/vision/vector/svg/lengths.h"
#include "common/vision/vector/vector_drawing.h"

namespace telekerf::vision {

/// The outermost viewport.
struct SvgPage {
  Vec2 size_m = Vec2::Zero();   ///< 0: the file does not say
  double metres = kCssPixel_m;  ///< a user unit, along the axis that is magnified less
  Vec2 units = Vec2::Zero();    ///< its size in user units
  Eigen::Affine2d view = Eigen::Affine2d::Identity();
  std::string size_from;  ///< what says how large a unit is
};

/// Units of width and height against the viewBox; otherwise pixels, as many an inch as was asked for, or as
/// the program took that wrote the `text`, or 96. The error is one sentence.
tl::expected<SvgPage, std::string> page_of(const tinyxml2::XMLElement& root, std::string_view text,
                                           const VectorRequest& request);

}  // namespace telekerf::vision
