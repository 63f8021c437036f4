// SPDX-License-Identifier: Apache-2.0
#include "common/control/joint_acceleration_control.h"

#include <Eigen/LU>

#include "common/control/tracking_law.h"

namespace telekerf::control {
JointAccelerationControl::JointAccelerationControl(const robot::RobotModel& nominal,
                                                   const JointAccelerationSettings& settings) noexcept
    : model_(nominal),
      kinematics_(nominal.geometry),
      settings_(settings),
      observer_(settings.observer),
      friction_(nominal.friction, settings.observer),
      plausibility_(nominal, settings.observer) {}

void JointAccelerationControl::reset(const Vec3& joints_m) noexcept {
  observer_.reset(joints_m);
  plausibility_.reset();
  now_ = {joints_m, Vec3::Zero()};
  if (const auto state = kinematics_.state(joints_m, Vec3::Zero())) state_ = *state;
  diagonal_kg_ = robot::joint_inertia(model_, state_).diagonal().asDiagonal();
}

bool JointAccelerationControl::observe(const robot::JointReading& reading) noexcept {
  observer_.predict();
  measured_ = settings_.judged ? plausibility_.accepts(reading, observer_) : reading.valid;
  if (measured_) observer_.correct(reading.joints_m);
  now_ = settings_.present
             ? observer_.ahead()
             : DisturbanceObserver::Ahead{observer_.joints_m(), observer_.joint_velocity_m_per_s()};
  if (settings_.friction_feedforward) friction_.update(now_.velocity_m_per_s);
  const auto state = kinematics_.state(now_.joints_m, now_.velocity_m_per_s);
  if (state) state_ = *state;
  posed_ = state.has_value();
  gravity_n_ = robot::gravity_force(model_, kinematics_, state_);
  modelled_n_ = robot::coriolis_force(model_, state_) + gravity_n_ + friction_.seen_n();
  if (posed_ && measured_ && settings_.judged) measured_ = explained();
  return posed_;
}

bool JointAccelerationControl::explained() noexcept {
  const Mat3 mobility = robot::joint_inertia(model_, state_).inverse();
  return plausibility_.explains(mobility * (observer_.disturbance_n() - modelled_n_), mobility * gravity_n_);
}

Vec3 JointAccelerationControl::reaction_force_n() const noexcept {
  return state_.inverse_jacobian.transpose() * (modelled_n_ - observer_.disturbance_n());
}

Vec3 JointAccelerationControl::within_limit_n(const Vec3& force_n, const Mat3& inertia_kg) const noexcept {
  const Vec3 tool = state_.tool_acceleration(inertia_kg.inverse() * (force_n - modelled_n_));
  const double most = model_.limits.acceleration_m_per_s2;
  if (!(tool.norm() > most)) return force_n;
  return inertia_kg * state_.joint_acceleration(limited(tool, most)) + modelled_n_;
}

Vec3 JointAccelerationControl::currents(const Vec3& desired_joint_acceleration_m_per_s2,
                                        const Vec3& known_n) noexcept {
  const Mat3 inertia_kg =
      settings_.inertia == NominalInertia::kModel ? robot::joint_inertia(model_, state_) : diagonal_kg_;
  const Vec3 unknown_n = observer_.disturbance_n() + friction_.missing_n();
  plausibility_.asked(desired_joint_acceleration_m_per_s2);
  Vec3 wanted_n = inertia_kg * desired_joint_acceleration_m_per_s2 + known_n + unknown_n;
  if (settings_.judged) wanted_n = within_limit_n(wanted_n, inertia_kg);
  if (!wanted_n.allFinite()) wanted_n.setZero();
  const double limit_n = model_.motor.peak_force_n;
  const Vec3 force_n = wanted_n.cwiseMax(-limit_n).cwiseMin(limit_n);
  saturated_ = force_n != wanted_n;
  observer_.applied(known_n.allFinite() ? Vec3(force_n - known_n) : force_n, inertia_kg);
  return force_n / model_.motor.force_constant_n_per_a;
}

Vec3 JointAccelerationControl::braking_m_per_s2(double bandwidth_rad_s) const noexcept {
  return -2.0 * bandwidth_rad_s * now_.velocity_m_per_s;
}

}  // namespace telekerf::control
