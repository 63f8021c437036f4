// SPDX-License-Identifier: Apache-2.0
// A controller and the joints under it: readings and references in, currents out, one step at a time.
#pragma once

#include "common/control/joint_acceleration_control.h"
#include "slave/machining/controller.h"

namespace telekerf::machining {

control::JointAccelerationSettings joint_settings(ControllerKind kind,
                                                  const PathFollowerSettings& settings) noexcept;
ModelUse model_use(ControllerKind kind, const PathFollowerSettings& settings) noexcept;

class PathFollower {
 public:
  PathFollower(const robot::RobotModel& nominal, const control::JointAccelerationSettings& joints,
               const Controller& controller, ModelUse model_use) noexcept
      : model_(nominal),
        kinematics_(nominal.geometry),
        origin_in_base_m_(nominal.in_base(Vec3::Zero())),
        ahead_(joints.observer.loop_delay + 0.5),
        model_use_(model_use),
        joints_(nominal, joints),
        controller_(controller) {}

  void reset(const Vec3& joints_m) noexcept;
  /// Another law from the next step on; at rest it is taken over without a jump.
  void use(const Controller& controller) noexcept { controller_ = controller; }
  /// Currents in A. A reference that is no pose of the robot gives the currents that hold it where it is.
  Vec3 step(const robot::JointReading& reading, const Trajectory& trajectory, double tick) noexcept;
  /// Observed tool, workpiece frame.
  Vec3 tool_m() const noexcept { return joints_.state().tool_m - origin_in_base_m_; }
  /// Share of the beam's power that gives each millimetre the same energy: what was planned, corrected by the
  /// observed speed along the path (corners, friction), at most half as much again.
  double beam_power(const Reference& reference) const noexcept;
  const control::JointAccelerationControl& joints() const noexcept { return joints_; }

 private:
  Vec3 expected_force(const Tracking& now) const noexcept;

  robot::RobotModel model_;
  robot::DeltaKinematics kinematics_;
  Vec3 origin_in_base_m_;
  double ahead_;  ///< samples until the currents act, on average
  ModelUse model_use_;
  Vec3 weight_n_ = Vec3::Zero();  ///< on the joints at the start
  control::JointAccelerationControl joints_;
  Controller controller_;
};

}  // namespace telekerf::machining
