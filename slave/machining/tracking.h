// SPDX-License-Identifier: Apache-2.0
// What every controller of a path gets to see at one tick.
#pragma once

#include "common/robot/dynamics.h"
#include "common/robot/robot_model.h"
#include "slave/machining/timed_path.h"

namespace telekerf::machining {

using robot::DeltaState;
using robot::Mat3;

/// All in the base frame but the trajectory, which is in the workpiece frame; `origin_in_base_m` moves it.
struct Tracking {
  const robot::DeltaKinematics& kinematics;
  const DeltaState& measured;
  const Trajectory& trajectory;
  double tick = 0.0;
  Vec3 origin_in_base_m = Vec3::Zero();
};

/// Reference in joint space (eq. 26-28); `good` false: the reference is no pose of the robot.
struct JointReference {
  Vec3 position_m = Vec3::Zero();
  Vec3 velocity_m_per_s = Vec3::Zero();
  Vec3 acceleration_m_per_s2 = Vec3::Zero();
  bool good = false;
};

inline JointReference joint_reference(const Tracking& now, const Reference& reference) noexcept {
  JointReference out;
  const auto joints = now.kinematics.inverse(now.origin_in_base_m + reference.position_m);
  if (!joints) return out;
  const auto inverse = now.kinematics.inverse_jacobian(*joints, now.origin_in_base_m + reference.position_m);
  if (!inverse) return out;
  out.position_m = *joints;
  out.velocity_m_per_s = *inverse * reference.velocity_m_per_s;
  const auto state = now.kinematics.state(*joints, out.velocity_m_per_s);
  if (!state) return out;
  out.acceleration_m_per_s2 = state->joint_acceleration(reference.acceleration_m_per_s2);
  out.good = true;
  return out;
}

}  // namespace telekerf::machining
