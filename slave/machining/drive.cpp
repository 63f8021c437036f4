// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/drive.h"

#include <algorithm>

namespace telekerf::machining {

Drive::Drive(const robot::RobotModel& nominal, const DriveSettings& settings) noexcept
    : model_(nominal), kinematics_(nominal.geometry), settings_(settings), observer_(settings.observer) {
  settings_.loop_delay = std::clamp(settings_.loop_delay, 0, kMaxLoopDelay);
  sent_n_.fill(Vec3::Zero());
}

void Drive::reset(const Vec3& joints_m) noexcept {
  observer_.reset(joints_m);
  if (const auto state = kinematics_.state(joints_m, Vec3::Zero())) state_ = *state;
  diagonal_kg_ = robot::joint_inertia(model_, state_).diagonal().asDiagonal();
  sent_n_.fill(Vec3::Zero());
}

bool Drive::observe(const robot::JointReading& reading) noexcept {
  observer_.update(reading.joints_m, reading.valid);
  const auto state = kinematics_.state(observer_.joints_m(), observer_.joint_velocity_m_per_s());
  if (!state) return false;
  state_ = *state;
  return true;
}

Vec3 Drive::currents(const Vec3& desired_joint_acceleration_m_per_s2, const Vec3& known_n) noexcept {
  const Mat3 inertia =
      settings_.inertia == NominalInertia::kModel ? robot::joint_inertia(model_, state_) : diagonal_kg_;
  Vec3 wanted = inertia * desired_joint_acceleration_m_per_s2 + known_n + observer_.disturbance_n();
  if (!wanted.allFinite()) wanted.setZero();
  const double limit = model_.motor.peak_force_n;
  const Vec3 force = wanted.cwiseMax(-limit).cwiseMin(limit);
  saturated_ = (force - wanted).squaredNorm() > 0.0;
  for (std::size_t i = sent_n_.size() - 1; i > 0; --i) sent_n_[i] = sent_n_[i - 1];
  sent_n_[0] = known_n.allFinite() ? Vec3(force - known_n) : force;
  // From now to the next reading acts what was sent `loop_delay` samples ago.
  observer_.applied(sent_n_[static_cast<std::size_t>(settings_.loop_delay)], inertia);
  return force / model_.motor.force_constant_n_per_a;
}

}  // namespace telekerf::machining
