// SPDX-License-Identifier: Apache-2.0
#include "common/control/acceleration_control.h"

#include <algorithm>

namespace telekerf::control {

AccelerationControl::AccelerationControl(const Settings& settings) noexcept
    : settings_(settings), observer_(settings.observer) {}

AccelerationControl::Settings AccelerationControl::settings_for(const robot::RobotModel& nominal,
                                                                const DisturbanceObserver::Gains& gains) {
  return {gains, nominal.motor.force_constant_n_per_a, nominal.motor.peak_force_n};
}

Vec3 AccelerationControl::currents(const Vec3& desired_joint_acceleration_m_per_s2,
                                   const Mat3& nominal_inertia_kg, const Vec3& compensation_n) noexcept {
  Vec3 wanted = nominal_inertia_kg * desired_joint_acceleration_m_per_s2 + compensation_n;
  if (!wanted.allFinite()) wanted.setZero();
  saturated_ = false;
  for (int i = 0; i < 3; ++i) {
    force_n_[i] = std::clamp(wanted[i], -settings_.force_limit_n, settings_.force_limit_n);
    saturated_ = saturated_ || force_n_[i] != wanted[i];
  }
  observer_.applied(force_n_, nominal_inertia_kg);
  return force_n_ / settings_.force_constant_n_per_a;
}

Vec3 reaction_force(const robot::RobotModel& nominal, const robot::DeltaKinematics& kinematics,
                    const robot::DeltaState& state, const Vec3& disturbance_n,
                    const Vec3& friction_n) noexcept {
  const Vec3 modelled =
      robot::coriolis_force(nominal, state) + robot::gravity_force(nominal, kinematics, state) + friction_n;
  return state.inverse_jacobian.transpose() * (modelled - disturbance_n);
}

}  // namespace telekerf::control
