// SPDX-License-Identifier: Apache-2.0
// Lengths of SVG: with units, and in those of the user.
#pragma once

#include <optional>
#include <tl/expected.hpp>

#include "common/runtime/vectors.h"
#include "common/vision/vector/drawn_lines.h"
#include "common/vision/vector/svg/cascade.h"

namespace tinyxml2 {
class XMLElement;
}

namespace telekerf::vision {

inline constexpr double kCssPixel_m = 25.4e-3 / 96.0;

/// Metres in a length like "20mm"; a per cent or an unknown unit is nothing.
std::optional<double> svg_length_m(const char* text);

/// The coordinates of one element in user units: units of length are turned into pixels, per cents are of the
/// viewport. What is no length fails the drawing.
class SvgCoordinates {
 public:
  /// `viewport`: its size, user units.
  SvgCoordinates(const tinyxml2::XMLElement& element, const Properties& own, const Vec2& viewport,
                 DrawnLines& out)
      : element_(element), own_(own), viewport_(viewport), out_(out) {}

  /// What the style says, or the attribute, or the fallback where it is not given or left to the viewer.
  double operator()(const char* attribute, double fallback = 0.0) const;

 private:
  const tinyxml2::XMLElement& element_;
  const Properties& own_;
  Vec2 viewport_;
  DrawnLines& out_;
};

}  // namespace telekerf::vision
