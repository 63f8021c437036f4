// SPDX-License-Identifier: Apache-2.0
#include "common/control/joint_plausibility.h"

#include <algorithm>
#include <cmath>

#include "common/robot/dynamics.h"
#include "common/robot/sensor_noise.h"

namespace telekerf::control {
namespace {

constexpr double kNoise = 15.0;       ///< rms of a reading
constexpr double kFriction = 3.0;     ///< it turns from one side to the other, and the robot may have more
constexpr double kChange = 0.1;       ///< of the largest acceleration, for what the model leaves out
constexpr double kUnexplained = 0.3;  ///< of the largest acceleration, 30 % wrong inertia
constexpr double kWeight = 0.4;       ///< of gravity, wrong masses
constexpr double kWrongForce = 0.9;   ///< 1.3 / 0.7 - 1: of each change of the currents' acceleration
constexpr double kFade = 0.5;         ///< a step, until the observer has it
constexpr double kSettling_s = 0.1;
constexpr int kRejected = 3;
constexpr int kPushed = 3;

/// Smallest inertia of a joint in the middle of the workspace.
double inertia_kg(const robot::RobotModel& model) noexcept {
  const robot::DeltaKinematics kinematics(model.geometry);
  const auto joints = kinematics.inverse(model.in_base(Vec3::Zero()));
  if (joints) {
    if (const auto pose = kinematics.state(*joints, Vec3::Zero()))
      return robot::joint_inertia(model, *pose).diagonal().minCoeff();
  }
  return model.motor.mass_kg;
}

/// The joint of the largest share of its bound, if it is beyond.
int worst_of(const Vec3& value, const Vec3& bound) noexcept {
  int joint = 0;
  return (value.cwiseAbs().cwiseQuotient(bound)).maxCoeff(&joint) > 1.0 ? joint : -1;
}

}  // namespace

JointPlausibility::JointPlausibility(const robot::RobotModel& nominal,
                                     const DisturbanceObserver::Gains& observer) noexcept
    : period_s_(observer.period_s), noise_m_(kNoise * robot::reading_noise_m(nominal.sensor)) {
  const double mass_kg = inertia_kg(nominal);
  friction_m_per_s2_ =
      kFriction * std::max(nominal.friction.breakaway_n, nominal.friction.coulomb_n) / mass_kg;
  change_m_per_s2_ = kChange * nominal.limits.acceleration_m_per_s2;
  const double gamma =
      observer_gains(observer.bandwidth_rad_per_s, observer.velocity_bandwidth_rad_per_s, period_s_).gamma;
  unexplained_m_per_s2_ = noise_m_ * gamma / (period_s_ * period_s_) + friction_m_per_s2_ +
                          kUnexplained * nominal.limits.acceleration_m_per_s2 +
                          kWeight * nominal.gravity_m_per_s2.norm();
  peak_m_per_s2_ = nominal.motor.peak_force_n / mass_kg;
  reset();
}

void JointPlausibility::reset() noexcept {
  settling_ = static_cast<int>(std::ceil(kSettling_s / period_s_));
  steps_ = rejected_ = pushed_ = 0;
}

Vec3 JointPlausibility::bound_m(const robot::JointReading& reading,
                                const Vec3& velocity_m_per_s) const noexcept {
  const double steps = steps_;
  const Vec3 change =
      Vec3::Constant(friction_m_per_s2_ + change_m_per_s2_) + kWrongForce * unsettled_m_per_s2_;
  Vec3 bound = Vec3::Constant(noise_m_) + steps * steps * period_s_ * period_s_ * change;
  if (reading.time_ns == 0 || time_ns_ == 0) return bound;
  // The device measured earlier or later than its turn was.
  const double late_s = std::abs(static_cast<double>(reading.time_ns - time_ns_) * 1e-9 - steps * period_s_);
  return bound + late_s * velocity_m_per_s.cwiseAbs() + Vec3::Constant(late_s * late_s * peak_m_per_s2_);
}

bool JointPlausibility::accepts(const robot::JointReading& reading,
                                const DisturbanceObserver& predicted) noexcept {
  const Vec3 change = (predicted.acceleration_m_per_s2() - acceleration_m_per_s2_).cwiseAbs();
  unsettled_m_per_s2_ = change.cwiseMax(kFade * unsettled_m_per_s2_);
  acceleration_m_per_s2_ = predicted.acceleration_m_per_s2();
  ++steps_;
  if (settling_ > 0) --settling_;
  if (!reading.valid) return false;
  const Vec3 innovation_m = reading.joints_m - predicted.joints_m();
  const int joint =
      settling_ > 0 ? -1 : worst_of(innovation_m, bound_m(reading, predicted.joint_velocity_m_per_s()));
  if (joint >= 0) {
    if (++rejected_ == kRejected && !doubt_)
      doubt_ = {robot::Doubt::Kind::kReading, joint, innovation_m[joint]};
    return false;
  }
  rejected_ = 0;
  steps_ = 0;
  time_ns_ = reading.time_ns;
  return true;
}

void JointPlausibility::unexplained(const Vec3& acceleration_m_per_s2) noexcept {
  const int joint =
      settling_ > 0 ? -1 : worst_of(acceleration_m_per_s2, Vec3::Constant(unexplained_m_per_s2_));
  pushed_ = joint >= 0 ? pushed_ + 1 : 0;
  if (pushed_ == kPushed && !doubt_)
    doubt_ = {robot::Doubt::Kind::kForce, joint, acceleration_m_per_s2[joint]};
}

}  // namespace telekerf::control
