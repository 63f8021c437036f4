// SPDX-License-Identifier: Apache-2.0
#include "common/robot/dynamics.h"

#include <cmath>

namespace telekerf::robot {

Mat3 joint_inertia(const RobotModel& robot, const DeltaState& state) noexcept {
  return robot.motor.mass_kg * Mat3::Identity() +
         robot.tool_mass_kg * state.jacobian.transpose() * state.jacobian;
}

Vec3 coriolis_force(const RobotModel& robot, const DeltaState& state) noexcept {
  return robot.tool_mass_kg * state.jacobian.transpose() *
         (state.jacobian_rate * state.joint_velocity_m_per_s);
}

Vec3 gravity_force(const RobotModel& robot, const DeltaKinematics& kinematics,
                   const DeltaState& state) noexcept {
  Vec3 force = -robot.tool_mass_kg * state.jacobian.transpose() * robot.gravity_m_per_s2;
  for (int i = 0; i < 3; ++i)
    force[i] -= robot.motor.mass_kg * kinematics.rail(i).dot(robot.gravity_m_per_s2);
  return force;
}

Vec3 friction_force(const Friction& friction, const Vec3& joint_velocity_m_per_s) noexcept {
  Vec3 force;
  for (int i = 0; i < 3; ++i) {
    const double v = joint_velocity_m_per_s[i];
    const double s = v / friction.stribeck_velocity_m_per_s;
    const double level = friction.coulomb_n + (friction.breakaway_n - friction.coulomb_n) * std::exp(-s * s);
    force[i] = level * std::tanh(v / friction.smoothing_velocity_m_per_s) + friction.viscous_n_s_per_m * v;
  }
  return force;
}

double energy(const RobotModel& robot, const DeltaKinematics& kinematics, const DeltaState& state) noexcept {
  double sum = 0.5 * robot.motor.mass_kg * state.joint_velocity_m_per_s.squaredNorm() +
               0.5 * robot.tool_mass_kg * state.tool_velocity_m_per_s.squaredNorm() -
               robot.tool_mass_kg * robot.gravity_m_per_s2.dot(state.tool_m);
  for (int i = 0; i < 3; ++i) {
    sum -= robot.motor.mass_kg * robot.gravity_m_per_s2.dot(kinematics.carriage(i, state.joints_m[i]));
  }
  return sum;
}

}  // namespace telekerf::robot
