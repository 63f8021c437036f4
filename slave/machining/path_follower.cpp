// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/path_follower.h"

#include <algorithm>

namespace telekerf::machining {

ModelUse model_use(ControllerKind kind, const PathFollowerSettings& s) noexcept {
  return kind == ControllerKind::kIndependent ? s.independent_model : s.model;
}

control::JointAccelerationSettings joint_settings(ControllerKind kind,
                                                  const PathFollowerSettings& s) noexcept {
  return {.observer = {.period_s = 1.0 / s.control_hz,
                       .bandwidth_rad_per_s = s.observer_rad_s,
                       .velocity_bandwidth_rad_per_s = s.velocity_rad_s,
                       .loop_delay = s.loop_delay},
          .inertia = model_use(kind, s) == ModelUse::kWhole ? control::NominalInertia::kModel
                                                            : control::NominalInertia::kDiagonal,
          .friction_feedforward = false};
}

void PathFollower::reset(const Vec3& joints_m) noexcept {
  joints_.reset(joints_m);
  weight_n_ = robot::gravity_force(model_, kinematics_, joints_.state());
}

/// Forces of the robot's file at the reference, where the currents will act.
Vec3 PathFollower::expected_force(const Tracking& now) const noexcept {
  if (model_use_ == ModelUse::kNone) return Vec3::Zero();
  const JointReference q = joint_reference(now, now.trajectory.at(now.tick + ahead_));
  if (!q.good) return Vec3::Zero();
  const Vec3 friction = robot::friction_force(model_.friction, q.velocity_m_per_s);
  if (model_use_ == ModelUse::kJoints) return weight_n_ + friction;
  const auto state = kinematics_.state(q.position_m, q.velocity_m_per_s);
  if (!state) return Vec3::Zero();
  return robot::gravity_force(model_, kinematics_, *state) + robot::coriolis_force(model_, *state) + friction;
}

double PathFollower::beam_power(const Reference& reference) const noexcept {
  if (!(reference.speed_m_per_s > 0.0)) return 0.0;
  const double speed = joints_.state().tool_velocity_m_per_s.dot(reference.tangent);
  return reference.power * std::clamp(speed / reference.speed_m_per_s, 0.0, 1.5);
}

Vec3 PathFollower::step(const robot::JointReading& reading, const Trajectory& trajectory,
                        double tick) noexcept {
  joints_.observe(reading);
  const Tracking now{kinematics_, joints_.state(), trajectory, tick, origin_in_base_m_};
  const Vec3 desired = desired_acceleration(controller_, now);
  return joints_.currents(desired.allFinite() ? desired : Vec3(Vec3::Zero()), expected_force(now));
}

}  // namespace telekerf::machining
