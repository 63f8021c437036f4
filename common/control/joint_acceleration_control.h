// SPDX-License-Identifier: Apache-2.0
// The joint controller chain of every robot (eq. 21-24): readings in, observed state and disturbance; desired
// joint accelerations in, motor currents out.
//
// Order within one control step: observe(reading), compute a desired acceleration from state(),
// currents(...), write them to the robot.
#pragma once

#include <cstdint>

#include "common/control/disturbance_observer.h"
#include "common/control/friction_feedforward.h"
#include "common/control/joint_plausibility.h"
#include "common/robot/dynamics.h"
#include "common/robot/robot.h"

namespace telekerf::control {

/// A_n of eq. 21.
enum class NominalInertia : std::uint8_t {
  kModel,     ///< A(q) of the robot's file
  kDiagonal,  ///< one constant a joint, as at reset(); the coupling is left to the observer (thesis 4.1)
};

struct JointAccelerationSettings {
  DisturbanceObserver::Gains observer;
  NominalInertia inertia = NominalInertia::kModel;
  /// Whether the modelled friction is given ahead where a joint turns round. Off where the caller's `known_n`
  /// holds the friction already.
  bool friction_feedforward = true;
  /// state() is where the joints are now, by the model, instead of where they were `loop_delay` samples ago
  /// when the drive read them. Off where the caller looks ahead by itself.
  bool present = false;
  /// Readings that cannot be true are left out, see doubt(), and whatever they say, the motors' force is one
  /// that accelerates the tool within the robot's limit, by its model. For a robot that nobody pushes.
  bool judged = false;
};

class JointAccelerationControl {
 public:
  JointAccelerationControl(const robot::RobotModel& nominal,
                           const JointAccelerationSettings& settings) noexcept;

  /// Starts over at rest at the measured joints; the disturbance starts from zero.
  void reset(const Vec3& joints_m) noexcept;

  /// First half of a step: the new measurement; an invalid reading, or one that cannot be true, is bridged by
  /// the model. False: the observed joints are no pose of this robot; state() then keeps the last one that
  /// was.
  bool observe(const robot::JointReading& reading) noexcept;

  /// The last observe() had a reading, and nothing speaks against it.
  bool measured() const noexcept { return measured_; }
  /// Whether the robot does what its motors are told; kNone where that is not judged.
  const robot::Doubt& doubt() const noexcept { return plausibility_.doubt(); }
  /// What the last observe() returned.
  bool posed() const noexcept { return posed_; }
  /// Observed joints and velocities, and all maps there; base frame.
  const robot::DeltaState& state() const noexcept { return state_; }
  const Vec3& joints_m() const noexcept { return now_.joints_m; }
  const Vec3& joint_velocity_m_per_s() const noexcept { return now_.velocity_m_per_s; }
  /// T_hat of eq. 23, N.
  const Vec3& disturbance_n() const noexcept { return observer_.disturbance_n(); }
  /// Force of the world on the tool, in base, N: what is left of the estimated disturbance when the modelled
  /// part (Coriolis, gravity, friction as late as the observer sees it) is taken out, mapped by J^-T. For
  /// NominalInertia::kModel with friction_feedforward.
  Vec3 reaction_force_n() const noexcept;

  /// Second half: i = K_n^-1 clip(A_n qdd_des + known + T_hat), A: all of the disturbance is put back, on the
  /// operator's robot the hand's force, too, which comes back along the curve through the virtual mass in the
  /// desired acceleration. `known_n`: force that a model expects beside inertia; the observer then estimates
  /// the rest only. What is not finite gives zero currents.
  Vec3 currents(const Vec3& desired_joint_acceleration_m_per_s2, const Vec3& known_n = Vec3::Zero()) noexcept;

  /// The desired acceleration when nothing better is known, as in a pose without kinematics: the joints are
  /// braked where they are.
  Vec3 braking_m_per_s2(double bandwidth_rad_s) const noexcept;

  /// True if a motor was at its limit in the last step.
  bool saturated() const noexcept { return saturated_; }

 private:
  bool explained() noexcept;
  /// What of a force accelerates the tool no more than the robot's limit, by the model.
  Vec3 within_limit_n(const Vec3& force_n, const Mat3& inertia_kg) const noexcept;

  robot::RobotModel model_;
  robot::DeltaKinematics kinematics_;
  JointAccelerationSettings settings_;
  DisturbanceObserver observer_;
  FrictionFeedforward friction_;
  JointPlausibility plausibility_;
  DisturbanceObserver::Ahead now_{Vec3::Zero(), Vec3::Zero()};
  robot::DeltaState state_;
  Mat3 diagonal_kg_ = Mat3::Identity();
  Vec3 gravity_n_ = Vec3::Zero();   ///< of the model, where the joints are observed
  Vec3 modelled_n_ = Vec3::Zero();  ///< disturbance that the model knows of, as late as the observer sees it
  bool posed_ = false;
  bool measured_ = false;
  bool saturated_ = false;
};

}  // namespace telekerf::control
