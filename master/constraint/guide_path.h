// SPDX-License-Identifier: Apache-2.0
// The curve that a hand is guided along, prepared outside the loop: evenly spaced points of contour / beta,
// the family of circles (or lines, or the descriptor's osculating circles) along it, and how fast its bends
// may be passed. Master's workpiece frame.
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/elliptic_fourier.h"
#include "common/geometry/nearest.h"
#include "common/protocol/messages.h"
#include "master/constraint/circle_family.h"
#include "master/constraint/constraint_settings.h"
#include "master/constraint/speed_limits.h"

namespace telekerf::master {

struct GuidePath {
  /// Contour (true size) for a master whose motion is scaled by `beta`; `settings` in the master's size.
  /// Allocates. Throws StartupError: a descriptor of an open contour, or one that the most harmonics do not
  /// bring within the tolerance.
  GuidePath(const ContourMessage& contour, double beta, const ConstraintSettings& settings);

  std::uint32_t contour_id;
  double beta;
  geometry::NearestIndex contour;  ///< contour / beta as it came
  geometry::NearestIndex curve;    ///< evenly spaced points along it, without its tightest bends

  bool closed() const noexcept { return curve.line().closed; }
  double length_m() const noexcept { return length_m_; }
  /// Distance along the guide of the point nearest to `tool_m`, over the whole of it.
  double find(const Vec2& tool_m) const noexcept;
  /// The same, but not farther than a local search looks from `arc_m`: the branch is kept at a crossing.
  double find_near(const Vec2& tool_m, double arc_m) const noexcept;
  /// What stands for the curve at `arc_m` (wrapped or clamped): a circle or line of its family, or the
  /// descriptor's osculating circle.
  GuidePiece at(double arc_m) const noexcept;
  SpeedLimit speed_limit(double arc_m) const noexcept;

 private:
  double wrapped(double arc_m) const noexcept;
  double refined(const Vec2& tool_m, const geometry::Nearest& nearest) const noexcept;
  GuidePiece described(double arc_m) const noexcept;

  std::optional<geometry::EllipticFourierPath> descriptor_;
  double spacing_m_;
  double length_m_;
  CircleFamily circles_;
  SpeedLimits limits_;
};

/// The same with the settings as they are kept, in the work's size.
inline GuidePath make_guide(const ContourMessage& contour, double beta, const ConstraintSettings& settings) {
  return GuidePath(contour, beta, in_masters_size(settings, beta));
}

}  // namespace telekerf::master
