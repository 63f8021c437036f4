// SPDX-License-Identifier: Apache-2.0
#include "master/constraint/constraint_generator.h"

#include <algorithm>
#include <cmath>

namespace telekerf::master {
namespace {

/// Farther than this from where the last circle says, the foot point is searched along the curve.
constexpr double kLost_m = 0.5e-3;
/// Share of a circle's radius nearer than which its centre is not approached: there phi has no gradient.
constexpr double kNearCentre = 0.5;
/// Faster than this no circle moves under the tool, but that the foot point jumps.
constexpr double kFastest_m_per_s = 0.05;

/// A tool far on the inner side of a bend would pass the centre and be held to the far side of the circle.
/// There a wider circle with the same foot point and tangent stands for the curve.
void flatten(GuidePiece& piece, const Vec2& tool_m) noexcept {
  const Vec2 along = piece.shape.tangent(piece.point_m);
  const double off = geometry::cross(along, tool_m - piece.point_m);
  const double bend = piece.shape.curvature();
  if (bend * off > 1.0 - kNearCentre)
    piece.shape = geometry::osculating(piece.point_m, along, (1.0 - kNearCentre) / off);
}

}  // namespace

ActiveConstraint ConstraintGenerator::at(const GuidePath& guide, const Vec2& tool_m, double dt_s) noexcept {
  ActiveConstraint active;
  if (!last_) {
    active.piece = guide.at(guide.find(tool_m));
  } else {
    // One Newton step along the last circle: a tick moves the foot by micrometres.
    const geometry::CircleOrLine& shape = last_->shape;
    const double bend = 1.0 - shape.curvature() * shape.phi(tool_m);
    const double step = shape.tangent(tool_m).dot(tool_m - last_->point_m) / std::max(bend, kNearCentre);
    active.piece = guide.at(last_->arc_m + std::clamp(step, -kLost_m, kLost_m));
    const double left = active.piece.shape.tangent(tool_m).dot(tool_m - active.piece.point_m);
    const bool at_end =
        !guide.closed() && (active.piece.arc_m <= 0.0 || active.piece.arc_m >= guide.length_m());
    if (std::abs(left) > kLost_m && !at_end)
      active.piece = guide.at(guide.find_near(tool_m, active.piece.arc_m));
  }
  flatten(active.piece, tool_m);
  active.phi_m = active.piece.shape.phi(tool_m);
  if (last_ && dt_s > 0.0) {
    active.drift_m_per_s =
        std::clamp((active.phi_m - last_->shape.phi(tool_m)) / dt_s, -kFastest_m_per_s, kFastest_m_per_s);
  }
  last_ = active.piece;
  active.limit = guide.speed_limit(active.piece.arc_m);
  if (!guide.closed()) {
    const double past = active.piece.shape.tangent(tool_m).dot(tool_m - active.piece.point_m);
    const bool at_start = active.piece.arc_m <= 0.0;
    const bool at_end = active.piece.arc_m >= guide.length_m();
    if ((at_start && past < 0.0) || (at_end && past > 0.0)) active.beyond_end_m = past;
  }
  return active;
}

}  // namespace telekerf::master
