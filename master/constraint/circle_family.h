// SPDX-License-Identifier: Apache-2.0
// The circles (or lines) along a curve (thesis 3.3, eq. 15-19): one for each place, fitted to the points
// around it, changing continuously from place to place.
#pragma once

#include <vector>

#include "common/geometry/circle_fit.h"
#include "common/geometry/polyline.h"
#include "common/runtime/vectors.h"
#include "master/constraint/constraint_settings.h"

namespace telekerf::master {

/// A place on the guide and the circle (or line) that stands for the curve there.
struct GuidePiece {
  double arc_m = 0.0;
  Vec2 point_m = Vec2::Zero();  ///< on the shape
  geometry::CircleOrLine shape;
};

class CircleFamily {
 public:
  /// `line`: evenly spaced by `spacing_m`. Chooses how many points a circle is fitted to: fewer where one
  /// cannot stand for all. Allocates.
  CircleFamily(const geometry::Polyline& line, double spacing_m, const ConstraintSettings& settings);

  /// Around `arc_m`, within the line's length; `line`: the same. The 2k + 1 points are weighted by a window
  /// that moves with the arc and is zero where a point enters or leaves, so that the circle changes
  /// continuously and a handover from one set of points to the next is no event.
  GuidePiece at(const geometry::Polyline& line, double arc_m) const noexcept;

 private:
  bool lines_;
  bool taper_;
  double min_radius_m_;
  double spacing_m_;
  std::vector<double> half_window_;  ///< k at the points
};

}  // namespace telekerf::master
