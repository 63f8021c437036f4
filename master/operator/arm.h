// SPDX-License-Identifier: Apache-2.0
// The arm between a pointer and the tool: a spring of limited force, so that whoever pulls with a mouse is
// confined by the constraint as a hand is.
#pragma once

#include "common/runtime/vectors.h"

namespace telekerf::master {

struct ArmSettings {
  double stiffness_n_per_m = 400.0;
  double damping_n_s_per_m = 20.0;
  double max_force_n = 4.0;  ///< what a wrist gives
};

/// Force on the tool, N, in plane; all in the master's workpiece frame. A pointer that is no number pulls
/// nothing.
inline Vec3 arm_force(const ArmSettings& arm, const Vec2& pointer_m, const Vec3& tool_m,
                      const Vec3& velocity_m_per_s) noexcept {
  Vec2 force = arm.stiffness_n_per_m * (pointer_m - tool_m.head<2>()) -
               arm.damping_n_s_per_m * velocity_m_per_s.head<2>();
  const double size = force.norm();
  if (!(size < 1e300)) return Vec3::Zero();
  if (size > arm.max_force_n) force *= arm.max_force_n / size;
  return {force.x(), force.y(), 0.0};
}

}  // namespace telekerf::master
