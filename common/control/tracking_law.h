// SPDX-License-Identifier: Apache-2.0
// The tracking law of both robots and of the master's commands (eq. 87 and 96 in operational space).
#pragma once

#include "common/control/kinematic_state.h"

namespace telekerf::control {

/// Acceleration that leads `tool` to `goal`: error dynamics e'' + 2 w e' + w^2 e = 0, critically damped.
inline Eigen::Vector3d tracking_acceleration(const KinematicState& goal, const KinematicState& tool,
                                             double w_rad_per_s) noexcept {
  return goal.acceleration_m_per_s2 + 2.0 * w_rad_per_s * (goal.velocity_m_per_s - tool.velocity_m_per_s) +
         w_rad_per_s * w_rad_per_s * (goal.position_m - tool.position_m);
}

/// The same direction, no longer than `max`.
inline Eigen::Vector3d limited(Eigen::Vector3d vector, double max) noexcept {
  const double size = vector.norm();
  if (size > max) vector *= max / size;
  return vector;
}

}  // namespace telekerf::control
