// SPDX-License-Identifier: Apache-2.0
#include "common/control/drive_trial.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/control/loop_design.h"
#include "common/control/tracking_law.h"

namespace telekerf::control {
namespace {

// Slow enough for readings that are ten milliseconds old, on a robot that is 30 % off its file.
constexpr double kHold_rad_per_s = 30.0;
constexpr LoopBandwidths kHold{kHold_rad_per_s, kObserverOverLaw* kHold_rad_per_s,
                               kVelocityOverObserver* kObserverOverLaw* kHold_rad_per_s};
/// The shaking lies between a quarter of this and this, at most, so that it is an eighth of the rate or less.
constexpr double kHighest_hz = 80.0;
/// Of the travel, for the shaking; the rest is for the weight, which the hold learns while it sags.
constexpr double kSwing = 0.1;
constexpr double kFadeIn_s = 0.2;
constexpr double kGentle = 0.4;  // of the continuous force

}  // namespace

DriveTrial::DriveTrial(const robot::RobotModel& nominal, const DriveTrialSettings& settings)
    : model_(nominal),
      settings_(settings),
      kinematics_(nominal.geometry),
      joints_(nominal, joints_of(nominal, kHold, settings.control_hz)),
      period_s_(1.0 / settings.control_hz),
      highest_hz_(std::min(kHighest_hz, settings.control_hz / 8.0)),
      settle_steps_(static_cast<std::size_t>(std::lround(settings.settle_s * settings.control_hz))),
      all_steps_(settle_steps_ +
                 static_cast<std::size_t>(std::lround(settings.duration_s * settings.control_hz))) {
  // Evenly between the joints, so that each can be told from the others.
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t n = 0; n < kSines; ++n) {
      const double place = static_cast<double>(3 * n + i) / (3 * kSines - 1);
      sine_hz_[i][n] = highest_hz_ * (0.25 + 0.75 * place);
    }
  }
  if (settings_.force_n <= 0.0) settings_.force_n = kGentle * nominal.motor.continuous_force_n;
  force_n_ = settings_.force_n;
  samples_.reserve(all_steps_ - settle_steps_);
}

void DriveTrial::begin(const Vec3& joints_m) noexcept {
  started_ = true;
  start_m_ = joints_m;
  joints_.reset(joints_m);
  const auto pose = kinematics_.state(joints_m, Vec3::Zero());
  if (!pose) return;
  // x = a / w^2 of every sine; all of them at their largest at once, the lightest joint.
  const double lightest_kg = robot::joint_inertia(model_, *pose).diagonal().minCoeff();
  double swing_m_per_n = 0.0;
  for (const auto& joint : sine_hz_) {
    double sum = 0.0;
    for (const double hz : joint) sum += std::pow(2.0 * std::numbers::pi * hz, -2) / kSines / lightest_kg;
    swing_m_per_n = std::max(swing_m_per_n, sum);
  }
  force_n_ = std::min(force_n_, kSwing * settings_.travel_m / swing_m_per_n);
}

Vec3 DriveTrial::shaking_n() const noexcept {
  if (steps_ < settle_steps_) return Vec3::Zero();
  const double time_s = static_cast<double>(steps_ - settle_steps_) * period_s_;
  Vec3 force_n = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto& joint = sine_hz_[static_cast<std::size_t>(i)];
    for (std::size_t n = 0; n < kSines; ++n) {
      // Phases by Schroeder: the sum stays flat.
      const double phase = std::numbers::pi * static_cast<double>(n * n) / kSines;
      force_n[i] += std::sin(2.0 * std::numbers::pi * joint[n] * time_s + phase) / kSines;
    }
  }
  // A flat sum of n sines stays below about 0.6 n of their largest possible sum; clipped to be sure.
  constexpr double kFlat = 0.6;
  const double fade = std::min(1.0, time_s / kFadeIn_s);
  return fade * force_n_ * (force_n / kFlat).cwiseMax(-1.0).cwiseMin(1.0);
}

Vec3 DriveTrial::step(const robot::JointReading& reading) noexcept {
  if (!started_ && reading.valid) begin(reading.joints_m);
  if (!started_ || state_ != State::kRunning) return Vec3::Zero();
  if (!joints_.observe(reading)) state_ = State::kNoPose;
  if (reading.valid) {
    farthest_m_ = std::max(farthest_m_, (reading.joints_m - start_m_).cwiseAbs().maxCoeff());
    if (farthest_m_ > settings_.travel_m) state_ = State::kTooFar;
  }
  if (steps_ == all_steps_) state_ = State::kDone;
  if (state_ != State::kRunning) return Vec3::Zero();

  const Mat3 to_acceleration = robot::joint_inertia(model_, joints_.state()).inverse();
  const SampledGains law = sampled_gains(kHold_rad_per_s, 1.0, period_s_);
  const Vec3 hold =
      law.position * (start_m_ - joints_.joints_m()) - law.velocity * joints_.joint_velocity_m_per_s();
  const Vec3 weight_n = robot::gravity_force(model_, kinematics_, joints_.state());
  Vec3 currents_a = joints_.currents(hold + to_acceleration * shaking_n(), weight_n);
  if (steps_++ >= settle_steps_) {
    samples_.push_back({reading.joints_m,
                        to_acceleration * (model_.motor.force_constant_n_per_a * currents_a), reading.valid});
  }
  return currents_a;
}

}  // namespace telekerf::control
