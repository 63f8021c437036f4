// SPDX-License-Identifier: Apache-2.0
// The tracking law of both robots and of the master's commands (eq. 87 and 96 in operational space).
#pragma once

#include <cmath>

#include "common/control/kinematic_state.h"

namespace telekerf::control {

/// a = -velocity e' - position e, held over each sample.
struct SampledGains {
  double position;
  double velocity;
};

/// Of the double integrator e'' = a, for the sampled poles exp(p T) of p^2 + 2 zeta w p + w^2 = 0. (The
/// continuous gains w^2 and 2 zeta w decay a tenth too fast at w T = 0.15.)
inline SampledGains sampled_gains(double w_rad_per_s, double zeta, double period_s) noexcept {
  const double wt = w_rad_per_s * period_s;
  const double inner = wt * std::sqrt(std::abs(zeta * zeta - 1.0));
  const double sum = 2.0 * std::exp(-zeta * wt) * (zeta >= 1.0 ? std::cosh(inner) : std::cos(inner));
  const double product = std::exp(-2.0 * zeta * wt);
  return {(1.0 - sum + product) / (period_s * period_s), (3.0 - sum - product) / (2.0 * period_s)};
}

/// Acceleration that leads `tool` to `goal` with these gains.
inline Eigen::Vector3d tracking_acceleration(const KinematicState& goal, const KinematicState& tool,
                                             const SampledGains& gains) noexcept {
  return goal.acceleration_m_per_s2 + gains.velocity * (goal.velocity_m_per_s - tool.velocity_m_per_s) +
         gains.position * (goal.position_m - tool.position_m);
}

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
