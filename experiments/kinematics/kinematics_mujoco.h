// SPDX-License-Identifier: Apache-2.0
// A delta robot in MuJoCo, an independent rigid-body engine: the part that the Cartesian robot plays in
// thesis 8.4.
//
// Nothing of the project's kinematics is inside: three carriages on slides, a tool that may move and turn
// freely, and three parallelograms of two massless rods each, held by equality constraints on their length.
#pragma once

#include <memory>

#include "common/robot/robot_model.h"

namespace telekerf::experiments {

class MujocoDelta {
 public:
  /// At rest with the carriages at `joints_m` and the tool at `tool_in_base_m`, which need not fit: see
  /// rod_error_m().
  MujocoDelta(const robot::RobotModel& robot, const Vec3& joints_m, const Vec3& tool_in_base_m,
              double timestep_s);
  ~MujocoDelta();
  MujocoDelta(MujocoDelta&&) noexcept;

  void set_motor_force(const Vec3& force_n);
  /// On the tool's centre, in base.
  void set_tool_force(const Vec3& force_in_base_n);
  void step();
  /// MuJoCo's forward pass (position, velocity, actuation, constraint, acceleration) without integration.
  void forward();
  /// Moves the carriages and the tool, at rest, without checking the rods.
  void place(const Vec3& joints_m, const Vec3& tool_in_base_m);

  double time_s() const;
  Vec3 joints_m() const;
  Vec3 joint_velocity_m_per_s() const;
  Vec3 tool_m() const;
  Vec3 tool_velocity_m_per_s() const;
  /// Mean length of each parallelogram's two rods minus the rod length: the engine's own constraint
  /// violation.
  Vec3 rod_error_m() const;
  /// Angle by which the tool has turned; the parallelograms should keep it at zero.
  double tilt_rad() const;

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
};

}  // namespace telekerf::experiments
