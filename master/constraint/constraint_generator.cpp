// SPDX-License-Identifier: Apache-2.0
#include "master/constraint/constraint_generator.h"

#include <algorithm>
#include <cmath>

namespace telekerf::master {
namespace {

/// Farther than this from the last foot point, or from where the last circle says, it is searched along the
/// curve.
constexpr double kSearch_m = 0.5e-3;
/// A search goes two millimetres along the curve: so often at most, and it has settled once it moves by less.
constexpr int kSearches = 8;
constexpr double kSettled_m = 1e-6;
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

/// The foot point of a tool that is far from where it was looked for.
double searched(const GuidePath& guide, const Vec2& tool_m, double arc_m) noexcept {
  for (int i = 0; i < kSearches; ++i) {
    const double found_m = guide.find_near(tool_m, arc_m);
    const double moved_m = std::remainder(found_m - arc_m, guide.length_m());
    arc_m = found_m;
    if (std::abs(moved_m) < kSettled_m) break;
  }
  return arc_m;
}

}  // namespace

ActiveConstraint ConstraintGenerator::at(const GuidePath& guide, const Vec2& tool_m, double dt_s) noexcept {
  ActiveConstraint active;
  if (!last_) {
    active.piece = guide.at(guide.find(tool_m));
  } else {
    // Along the last circle to the tool's foot point on it: a tick moves it by micrometres.
    const double step = last_->shape.tangent(tool_m).dot(tool_m - last_->point_m);
    active.piece = guide.at(last_->arc_m + std::clamp(step, -kSearch_m, kSearch_m));
    const double left = active.piece.shape.tangent(tool_m).dot(tool_m - active.piece.point_m);
    const bool at_end =
        !guide.closed() && (active.piece.arc_m <= 0.0 || active.piece.arc_m >= guide.length_m());
    const bool lost = std::abs(step) > kSearch_m || std::abs(left) > kSearch_m;
    if (lost && !at_end) active.piece = guide.at(searched(guide, tool_m, active.piece.arc_m));
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
