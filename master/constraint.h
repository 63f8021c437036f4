// SPDX-License-Identifier: Apache-2.0
// The virtual constraint of thesis 3.3 and 5.1-5.2: a circle through the points around the tool (Algorithm
// 1), and the acceleration that keeps the tool on it (eq. 58-78 with eq. 165 corrected). Master's workpiece
// frame.
#pragma once

#include <cstdint>
#include <optional>

#include "common/bus/messages.h"
#include "common/geometry/circle_fit.h"
#include "common/geometry/nearest.h"

namespace telekerf::master {

struct ConstraintSettings {
  int half_window = 4;             ///< k of eq. 15, points to either side
  double spacing_m = 0.15e-3;      ///< between the points of the guide
  double bandwidth_rad_s = 110.0;  ///< of the error decay across the curve and in z (eq. 65)
  double damping = 1.0;
  double mass_kg = 0.5;               ///< virtual mass that the hand moves along the curve
  double drag_ns_per_m = 2.0;         ///< virtual damping along it
  double dead_force_n = 0.05;         ///< estimated forces below this do not move the tool
  double corner_m = 50e-6;            ///< overshooting a corner by more meets the same soft stop as an end
  double end_bandwidth_rad_s = 60.0;  ///< soft stops at the ends of an open curve
};

/// The curve that the operator may trace: contour / beta, evenly spaced points. Built outside the loop.
struct Guide {
  std::uint32_t contour_id = 0;
  double beta = 1.0;
  geometry::NearestIndex curve;
};

/// Contour (true size) -> guide for a master whose motion is scaled by `beta`.
Guide make_guide(const ContourMessage& contour, double beta, const ConstraintSettings& settings);

/// The circle (or line) that is in force for one tick; frozen within it (c' = 0).
struct ActiveConstraint {
  geometry::CircleOrLine shape;
  geometry::Nearest nearest;
  double beyond_end_m =
      0.0;  ///< how far the tool is past an end of an open curve, along the tangent (signed)
};

/// Algorithm 1 with a local search from the last nearest point, so that a tool at a crossing stays on its
/// branch.
class ConstraintGenerator {
 public:
  explicit ConstraintGenerator(const ConstraintSettings& settings) noexcept : settings_(settings) {}
  void reset() noexcept { last_segment_.reset(); }
  ActiveConstraint at(const Guide& guide, const Vec2& tool_m) noexcept;

 private:
  ConstraintSettings settings_;
  std::optional<std::size_t> last_segment_;
};

/// Desired tool acceleration: phi'' + K2 phi' + K1 phi = 0 across the curve and in z (eq. 65), and along it
/// what the hand's force does to the virtual mass. `hand_n`: estimated hand force on the tool.
Vec3 constrained_acceleration(const ActiveConstraint& active, const ConstraintSettings& settings,
                              const Vec3& tool_m, const Vec3& velocity_m_per_s, const Vec3& hand_n) noexcept;

}  // namespace telekerf::master
