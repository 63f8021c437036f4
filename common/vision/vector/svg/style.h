// SPDX-License-Identifier: Apache-2.0
// What an SVG element looks like, as far as it decides what is cut.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "common/vision/vector/svg/cascade.h"

namespace telekerf::vision {

/// What an element has of its own and from those around it.
struct Look {
  std::string fill = "black";
  std::string stroke = "none";
  std::string color = "black";
  std::string stroke_width = "1";
  std::string dashes = "none";
  double fill_opacity = 1.0;
  double stroke_opacity = 1.0;
  bool visible = true;
  bool displayed = true;     ///< it and all around it
  bool passed_over = false;  ///< its conditions are not met, or another branch of a switch is shown
  bool opaque = true;        ///< likewise, even if only a little
  bool markers = false;
  bool clips_even_odd = false;  ///< as part of a clip-path: overlaps are holes
};

/// The look of an element within another.
Look look_of(const Properties& own, const Look& around);

/// Whether `id` is defined in the file: a paint that is not is none.
using IsDefined = std::function<bool(std::string_view id)>;

struct Painted {
  bool fill = false;
  bool stroke = false;
  bool white = false;      ///< what fills it
  std::string colour;      ///< of the stroke, or else of the area: #rrggbb, or the word that the file has
  std::string why_hidden;  ///< empty: it is shown
};
/// How an element with this look is painted; `area`: it can be filled.
Painted painted(const Look& look, bool area, const IsDefined& is_defined);

/// What cannot be followed and would move the element; empty: nothing.
std::string trouble_of(const Properties& own);

}  // namespace telekerf::vision
