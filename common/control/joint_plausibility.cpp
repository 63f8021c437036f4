// SPDX-License-Identifier: Apache-2.0
#include "common/control/joint_plausibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "common/robot/dynamics.h"
#include "common/robot/sensor_noise.h"

namespace telekerf::control {
namespace {

using Kind = robot::Doubt::Kind;

constexpr double kNoise = 15.0;         ///< rms of a reading
constexpr double kFriction = 3.0;       ///< it turns from one side to the other, and the robot may have more
constexpr double kLimit = 0.05;         ///< of the largest acceleration, for what the model leaves out
constexpr double kOthers = 0.5;         ///< of the weight that the joints seem to have beside their file's
constexpr double kWrongForce = 0.9;     ///< 1.3 / 0.7 - 1: of what the currents are to do
constexpr double kWrongInertia = 0.45;  ///< of what is asked of the joints
constexpr double kSpeeds = 3.0;         ///< of the largest: what moves before it is judged moves no faster
constexpr double kFade = 0.5;           ///< a step, until the observer has a change of the currents
constexpr double kSlow_s = 0.3;         ///< of the disturbance's mean: weight, payload
constexpr double kSettling_s = 0.1;     ///< at most
constexpr double kSettled_s = 0.02;     ///< once readings are where they are to be; and at least
constexpr double kSettled = 5.0;        ///< time constants of the observer
constexpr int kDoubts = 2;  ///< readings in a row; a force is filtered already, and grows within milliseconds

/// Smallest inertia of a joint in the middle of the workspace.
double inertia_kg(const robot::RobotModel& model) noexcept {
  const robot::DeltaKinematics kinematics(model.geometry);
  const auto joints = kinematics.inverse(model.in_base(Vec3::Zero()));
  if (!joints) return model.motor.mass_kg;
  const auto pose = kinematics.state(*joints, Vec3::Zero());
  return pose ? robot::joint_inertia(model, *pose).diagonal().minCoeff() : model.motor.mass_kg;
}

/// The joint that is farthest beyond its bound; negative: none is.
int beyond(const Vec3& value, const Vec3& bound) noexcept {
  int joint = 0;
  return value.cwiseAbs().cwiseQuotient(bound).maxCoeff(&joint) > 1.0 ? joint : -1;
}

/// How many times more weight than their model's the joints have (payload: more than 0; without weight: -1),
/// by the middle one of those whose weight is beyond `least`; nullopt: fewer than two are.
std::optional<double> more_weight(const Vec3& beside_m_per_s2, const Vec3& weight_m_per_s2,
                                  double least_m_per_s2) noexcept {
  std::array<double, 3> more;
  more.fill(std::numeric_limits<double>::infinity());
  std::size_t n = 0;
  for (int i = 0; i < 3; ++i) {
    if (std::abs(weight_m_per_s2[i]) > least_m_per_s2) more[n++] = beside_m_per_s2[i] / weight_m_per_s2[i];
  }
  std::sort(more.begin(), more.end());
  if (n < 2) return std::nullopt;
  return n == 2 ? 0.5 * (more[0] + more[1]) : more[1];
}

/// How much earlier or later than it was due the device has measured, by its own clock.
double untimely_s(std::int64_t time_ns, std::int64_t before_ns, double due_s) noexcept {
  if (time_ns == 0 || before_ns == 0) return 0.0;
  return std::abs(static_cast<double>(time_ns - before_ns) * 1e-9 - due_s);
}

int steps_of(double time_s, double period_s) noexcept {
  return static_cast<int>(std::ceil(time_s / period_s));
}

}  // namespace

JointPlausibility::JointPlausibility(const robot::RobotModel& nominal,
                                     const DisturbanceObserver::Gains& observer) noexcept
    : period_s_(observer.period_s),
      noise_m_(kNoise * robot::reading_noise_m(nominal.sensor)),
      slow_share_(1.0 - std::exp(-period_s_ / kSlow_s)),
      forget_(std::exp(-0.5 * observer.bandwidth_rad_per_s * period_s_)) {
  const double mass_kg = inertia_kg(nominal);
  const double friction_n = std::max(nominal.friction.breakaway_n, nominal.friction.coulomb_n);
  usual_m_per_s2_ = kFriction * friction_n / mass_kg + kLimit * nominal.limits.acceleration_m_per_s2;
  const double gamma =
      observer_gains(observer.bandwidth_rad_per_s, observer.velocity_bandwidth_rad_per_s, period_s_).gamma;
  noise_m_per_s2_ = noise_m_ * gamma / (period_s_ * period_s_);
  settled_ = steps_of(std::max(kSettled_s, kSettled / observer.bandwidth_rad_per_s), period_s_);
  fastest_m_per_s_ = kSpeeds * nominal.limits.velocity_m_per_s;
  peak_m_per_s2_ = nominal.motor.peak_force_n / mass_kg;
  reset();
}

void JointPlausibility::reset() noexcept {
  settling_ = steps_of(kSettling_s, period_s_);
  steps_ = doubted_ = expected_ = 0;
}

Vec3 JointPlausibility::gate_m(const robot::JointReading& reading,
                               const Vec3& velocity_m_per_s) const noexcept {
  // A reading that was not believed does not widen the gate for the next.
  const double apart_s = (steps_ - doubted_) * period_s_;
  const Vec3 change = Vec3::Constant(usual_m_per_s2_) + kWrongForce * unsettled_m_per_s2_;
  const double late_s = untimely_s(reading.time_ns, time_ns_, steps_ * period_s_);
  return Vec3::Constant(noise_m_ + late_s * late_s * peak_m_per_s2_) + apart_s * apart_s * change +
         late_s * velocity_m_per_s.cwiseAbs();
}

bool JointPlausibility::accepts(const robot::JointReading& reading,
                                const DisturbanceObserver& predicted) noexcept {
  const Vec3& forced_m_per_s2 = predicted.acceleration_m_per_s2();
  unsettled_m_per_s2_ = (forced_m_per_s2 - forced_m_per_s2_).cwiseAbs().cwiseMax(kFade * unsettled_m_per_s2_);
  forced_m_per_s2_ = forced_m_per_s2;
  ++steps_;
  if (!reading.valid) return false;
  if (settling_ > 0) --settling_;
  const Vec3 innovation_m = reading.joints_m - predicted.joints_m();
  const Vec3 gate = gate_m(reading, predicted.joint_velocity_m_per_s());
  const int joint = beyond(innovation_m, gate);
  const double any_motion_m = fastest_m_per_s_ * static_cast<double>(steps_) * period_s_;
  if (joint >= 0 && (!unsure() || beyond(innovation_m, gate + Vec3::Constant(any_motion_m)) >= 0))
    return note(Kind::kReading, joint, innovation_m[joint]);
  expected_ = joint >= 0 ? std::min(expected_, 0) : std::min(expected_ + 1, kExpected);
  if (!unsure()) settling_ = std::min(settling_, settled_);
  // What it makes of the observer is no force.
  if (untimely_s(reading.time_ns, time_ns_, steps_ * period_s_) > 0.5 * period_s_) {
    settling_ = steps_of(kSettling_s, period_s_);
    expected_ = -settling_;  // whose readings come out of time is not judged sooner
  }
  steps_ = 0;
  time_ns_ = reading.time_ns;
  return true;
}

bool JointPlausibility::explains(const Vec3& disturbance_m_per_s2, const Vec3& weight_m_per_s2) noexcept {
  if (settling_ > 0) {
    doubted_ = 0;
    slow_m_per_s2_ = disturbance_m_per_s2;
    return true;
  }
  const Vec3 change = disturbance_m_per_s2 - slow_m_per_s2_;
  const Vec3 bound = Vec3::Constant(noise_m_per_s2_ + usual_m_per_s2_) + kWrongInertia * asked_m_per_s2_;
  if (const int joint = beyond(change, bound); joint >= 0) return note(Kind::kForce, joint, change[joint]);
  if (const auto more = more_weight(slow_m_per_s2_, weight_m_per_s2, usual_m_per_s2_)) {
    const Vec3 payload = *more * weight_m_per_s2, alone = slow_m_per_s2_ - payload;
    const int joint = beyond(alone, bound + kOthers * payload.cwiseAbs());
    if (joint >= 0) return note(Kind::kForce, joint, alone[joint]);
  }
  slow_m_per_s2_ += slow_share_ * change;
  doubted_ = 0;
  return true;
}

bool JointPlausibility::note(Kind kind, int joint, double value) noexcept {
  const bool sure = ++doubted_ >= kDoubts || kind == Kind::kForce;
  if (sure && !doubt_) doubt_ = {kind, joint, value};
  return false;
}

void JointPlausibility::asked(const Vec3& acceleration_m_per_s2) noexcept {
  asked_m_per_s2_ = acceleration_m_per_s2.cwiseAbs().cwiseMax(forget_ * asked_m_per_s2_);
}

}  // namespace telekerf::control
