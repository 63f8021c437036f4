// SPDX-License-Identifier: Apache-2.0
// Sharp corners, which lens, filter and thinning have rounded, are put back where their two sides meet.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf::vision {

struct CornerRule {
  double rounded_px = 4.0;       ///< this far from a corner its sides are straight again
  double side_px = 8.0;          ///< length of a side that is looked at
  double max_distance_px = 3.0;  ///< a corner further than this from the rounded line is none
  /// Sigma of lens and filter across a region's border, where known: it says how far a corner of each angle
  /// has been rounded off, in place of `rounded_px` and `max_distance_px`.
  double blur_px = 0.0;
  /// Width of the pen: the two sides of a sharp corner have grown together near it.
  double pen_px = 0.0;
  double min_turn_rad = 0.6;
  /// Says whether the picture agrees with a corner here, which points along `outwards`.
  std::function<bool(const Vec2& corner, const Vec2& outwards)> agrees = {};
  /// Where a corner of less than about 65 degrees lies: its sides have grown together and say little. Unset:
  /// nowhere.
  std::function<std::optional<Vec2>(const Vec2& rounded, const Vec2& outwards)> tip = {};
  /// Set with `tip`: the point lies in the middle of one stroke and of nothing else.
  std::function<bool(const Vec2& point, const Vec2& tangent)> single = {};
};

/// Points about one pixel apart. A corner is made where both sides are straight to 0.3 px; curves stay as
/// they are.
void sharpen_corners(std::vector<Vec2>& points, bool closed, const CornerRule& rule);

}  // namespace telekerf::vision
