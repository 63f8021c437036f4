// SPDX-License-Identifier: Apache-2.0
// Rigid-body dynamics in joint space (eq. 20): carriages and tool as point masses, rods without mass.
//
//   A(q) qdd + B(q, qd) + G(q) + friction(qd) = K i + J^T F_tool
//
// F_tool is the force that the world (an operator's hand) exerts on the tool; the thesis' T_ext is -J^T
// F_tool.
#pragma once

#include "common/robot/robot_model.h"

namespace telekerf::robot {

/// A = m_motor I + m_tool J^T J, kg.
Mat3 joint_inertia(const RobotModel& robot, const DeltaState& state) noexcept;
/// B = m_tool J^T Jdot qd, N.
Vec3 coriolis_force(const RobotModel& robot, const DeltaState& state) noexcept;
/// G, N: force that the motors need to hold the pose.
Vec3 gravity_force(const RobotModel& robot, const DeltaKinematics& kinematics,
                   const DeltaState& state) noexcept;
/// Friction at joint velocity `qd`, N, along the velocity (Coulomb, smooth Stribeck, viscous).
Vec3 friction_force(const Friction& friction, const Vec3& joint_velocity_m_per_s) noexcept;

/// Kinetic plus potential energy, J.
double energy(const RobotModel& robot, const DeltaKinematics& kinematics, const DeltaState& state) noexcept;

}  // namespace telekerf::robot
