// SPDX-License-Identifier: Apache-2.0
// Acceleration control (eq. 24): joint accelerations in, motor currents out, the estimated disturbance put
// back.
//
// Order within one control step: observe(reading), compute a desired acceleration, currents(...), write.
#pragma once

#include "common/control/disturbance_observer.h"
#include "common/robot/dynamics.h"
#include "common/robot/robot.h"

namespace telekerf::control {

class AccelerationControl {
 public:
  struct Settings {
    DisturbanceObserver::Gains observer;
    double force_constant_n_per_a = 1;  ///< K_n
    double force_limit_n = 1;           ///< of one motor
  };

  explicit AccelerationControl(const Settings& settings) noexcept;

  /// Settings of a robot by its file: peak force as the limit.
  static Settings settings_for(const robot::RobotModel& nominal, const DisturbanceObserver::Gains& gains);

  /// Starts over at rest at the measured joints.
  void reset(const Vec3& joints_m) noexcept { observer_.reset(joints_m); }

  /// First half of a step: the new measurement. An invalid reading is bridged by the model.
  void observe(const robot::JointReading& reading) noexcept {
    observer_.update(reading.joints_m, reading.valid);
  }

  const Vec3& joints_m() const noexcept { return observer_.joints_m(); }
  const Vec3& joint_velocity_m_per_s() const noexcept { return observer_.joint_velocity_m_per_s(); }
  /// T_hat of eq. 23 in N; pass it (or the part to be rejected) to currents().
  const Vec3& disturbance_n() const noexcept { return observer_.disturbance_n(); }

  /// Second half: i = K_n^-1 clip(A_n qdd_des + compensation), A. `compensation_n` is what is put back
  /// of the disturbance: all of it, on the operator's robot too. The hand's force that is in it is rejected
  /// with the rest, and moves the tool along the curve through the virtual mass in the desired acceleration.
  /// A desired acceleration that is not finite gives zero current.
  Vec3 currents(const Vec3& desired_joint_acceleration_m_per_s2, const Mat3& nominal_inertia_kg,
                const Vec3& compensation_n) noexcept;

  /// True if a motor was at its limit in the last step.
  bool saturated() const noexcept { return saturated_; }
  /// Force that the last currents ask for, after clipping, N.
  const Vec3& force_n() const noexcept { return force_n_; }

 private:
  Settings settings_;
  DisturbanceObserver observer_;
  Vec3 force_n_ = Vec3::Zero();
  bool saturated_ = false;
};

/// Force of the world on the tool, in base, N: what is left of the estimated disturbance when the modelled
/// part (Coriolis, gravity, friction) is taken out, mapped by J^-T. Valid for A_n = A(q)
/// (robot::joint_inertia). `friction_n`: of the joints by the model; while it changes, as late as the
/// observer sees it (FrictionFeedforward::seen_n).
Vec3 reaction_force(const robot::RobotModel& nominal, const robot::DeltaKinematics& kinematics,
                    const robot::DeltaState& state, const Vec3& disturbance_n,
                    const Vec3& friction_n) noexcept;

}  // namespace telekerf::control
