// SPDX-License-Identifier: Apache-2.0
#include "common/control/disturbance_observer.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace telekerf::control {

DisturbanceObserver::DisturbanceObserver(const Gains& gains) noexcept
    : period_s_(gains.period_s), loop_delay_(std::clamp(gains.loop_delay, 0, kMaxLoopDelay)) {
  forces_n_.fill(Vec3::Zero());
  const double r1 = 1 - std::exp(-gains.bandwidth_rad_per_s * period_s_);
  const double r2 = 1 - std::exp(-gains.velocity_bandwidth_rad_per_s * period_s_);
  const double c1 = r1 + 2 * r2;
  const double c2 = 2 * r1 * r2 + r2 * r2;
  const double c3 = r1 * r2 * r2;
  alpha_ = c1 - c2 + c3;
  beta_ = c2 - 1.5 * c3;
  gamma_ = c3;
}

void DisturbanceObserver::reset(const Vec3& joints_m) noexcept {
  q_ = joints_m;
  v_.setZero();
  w_.setZero();
  acceleration_.setZero();
  disturbance_n_.setZero();
  forces_n_.fill(Vec3::Zero());
}

void DisturbanceObserver::applied(const Vec3& force_n, const Mat3& nominal_inertia_kg) noexcept {
  nominal_inertia_kg_ = nominal_inertia_kg;
  const auto delay = static_cast<std::size_t>(loop_delay_);
  for (std::size_t i = delay; i > 0; --i) forces_n_[i] = forces_n_[i - 1];
  forces_n_[0] = force_n;
  acceleration_ = nominal_inertia_kg.inverse() * forces_n_[delay];
}

void DisturbanceObserver::update(const Vec3& measured_joints_m, bool valid) noexcept {
  const double t = period_s_;
  const Vec3 total = acceleration_ + w_;
  q_ += t * v_ + 0.5 * t * t * total;
  v_ += t * total;
  if (valid) {
    const Vec3 innovation = measured_joints_m - q_;
    q_ += alpha_ * innovation;
    v_ += beta_ / t * innovation;
    w_ += gamma_ / (t * t) * innovation;
  }
  disturbance_n_ = -nominal_inertia_kg_ * w_;
}

}  // namespace telekerf::control
