// SPDX-License-Identifier: Apache-2.0
// A tool's motion, and how it goes on over one step of held acceleration. Master and slave integrate with
// these very lines, so that the master's model of the slave's reference is that reference, bit for bit.
#pragma once

#include <Eigen/Core>

namespace telekerf::control {

/// Position, velocity, acceleration of the tool, workpiece frame.
struct KinematicState {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_m_per_s2 = Eigen::Vector3d::Zero();
};

/// x' = Phi x + Gamma a, Phi = [1 h; 0 1], Gamma = [h^2/2; h]: exact for an acceleration held over `h_s`,
/// which may be negative. The acceleration stays.
inline KinematicState advanced(KinematicState motion, double h_s) noexcept {
  motion.position_m += h_s * motion.velocity_m_per_s + (0.5 * h_s * h_s) * motion.acceleration_m_per_s2;
  motion.velocity_m_per_s += h_s * motion.acceleration_m_per_s2;
  return motion;
}

/// The state before: from where `acceleration_m_per_s2`, held over `h_s`, led to `after`. The inverse of
/// advanced(), up to rounding.
inline KinematicState preceding(const KinematicState& after, const Eigen::Vector3d& acceleration_m_per_s2,
                                double h_s) noexcept {
  KinematicState before;
  before.acceleration_m_per_s2 = acceleration_m_per_s2;
  before.velocity_m_per_s = after.velocity_m_per_s - h_s * acceleration_m_per_s2;
  before.position_m =
      after.position_m - h_s * before.velocity_m_per_s - (0.5 * h_s * h_s) * acceleration_m_per_s2;
  return before;
}

}  // namespace telekerf::control
