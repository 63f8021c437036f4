// SPDX-License-Identifier: Apache-2.0
// A smooth curve through given points.
#pragma once

#include <vector>

#include "common/vision/vector/curve_writer.h"

namespace telekerf::vision {

struct FitPoints {
  std::vector<Vec2> points;           ///< two or more
  Vec2 start_tangent = Vec2::Zero();  ///< its direction; zero: the curve ends without curvature
  Vec2 end_tangent = Vec2::Zero();
  bool closed = false;
};

/// Draws the cubic spline that runs through the points, its parameter the length of the chords: tangent and
/// curvature have no jump. Of points that lie on each other there is one.
void draw(const FitPoints& fit, CurveWriter& writer);

}  // namespace telekerf::vision
