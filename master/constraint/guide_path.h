// SPDX-License-Identifier: Apache-2.0
// The curve that a hand is guided along, prepared outside the loop: evenly spaced points of contour / beta,
// the family of circles (or lines, or the descriptor's osculating circles) along it, and how fast its bends
// may be passed. Master's workpiece frame.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/circle_fit.h"
#include "common/geometry/elliptic_fourier.h"
#include "common/geometry/nearest.h"
#include "common/protocol/messages.h"
#include "master/constraint/constraint_settings.h"

namespace telekerf::master {

/// A place on the guide and the circle (or line) that stands for the curve there.
struct GuidePiece {
  double arc_m = 0.0;
  Vec2 point_m = Vec2::Zero();  ///< on the shape
  geometry::CircleOrLine shape;
};

struct GuidePath {
  /// Contour (true size) for a master whose motion is scaled by `beta`. Allocates. Throws StartupError: a
  /// descriptor of an open contour, or one that the most harmonics do not bring within the tolerance.
  GuidePath(const ContourMessage& contour, double beta, const ConstraintSettings& settings);

  std::uint32_t contour_id;
  double beta;
  geometry::NearestIndex curve;  ///< evenly spaced points of contour / beta

  bool closed() const noexcept { return curve.line().closed; }
  double length_m() const noexcept { return length_m_; }
  /// Distance along the guide of the point nearest to `tool_m`, over the whole of it.
  double find(const Vec2& tool_m) const noexcept;
  /// The same, but not farther than a local search looks from `arc_m`: the branch is kept at a crossing.
  double find_near(const Vec2& tool_m, double arc_m) const noexcept;
  /// Eq. 15-19 around `arc_m` (wrapped or clamped): the 2k + 1 points are weighted by a window that moves
  /// with the arc and is zero where a point enters or leaves, so that the circle changes continuously and a
  /// handover from one set of points to the next is no event.
  GuidePiece at(double arc_m) const noexcept;

  /// How fast the tool may run at `arc_m` if it is to be slow enough in every bend ahead, either way, and the
  /// derivative of that along the arc (1/s).
  struct SpeedLimit {
    double m_per_s;
    double slope_per_s;
  };
  SpeedLimit speed_limit(double arc_m) const noexcept;

 private:
  double wrapped(double arc_m) const noexcept;
  double refined(const Vec2& tool_m, const geometry::Nearest& nearest) const noexcept;
  GuidePiece fitted(double arc_m) const noexcept;
  GuidePiece described(double arc_m) const noexcept;
  void fit_windows();
  void limit_speed();

  ConstraintSettings settings_;
  CurveKind kind_;
  std::optional<geometry::EllipticFourierPath> descriptor_;
  double spacing_m_ = 0.0;
  double length_m_ = 0.0;
  std::vector<double> half_window_;    ///< k at the points: smaller where one circle cannot stand for all
  std::vector<double> limit_m_per_s_;  ///< at the points
};

inline GuidePath make_guide(const ContourMessage& contour, double beta, const ConstraintSettings& settings) {
  return GuidePath(contour, beta, settings);
}

}  // namespace telekerf::master
