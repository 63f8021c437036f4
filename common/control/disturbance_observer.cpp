// SPDX-License-Identifier: Apache-2.0
#include "common/control/disturbance_observer.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstddef>

namespace telekerf::control {
namespace {

/// Exact for an acceleration held over `h_s`.
void move(Vec3& q_m, Vec3& v_m_per_s, const Vec3& acceleration_m_per_s2, double h_s) noexcept {
  q_m += h_s * v_m_per_s + 0.5 * h_s * h_s * acceleration_m_per_s2;
  v_m_per_s += h_s * acceleration_m_per_s2;
}

}  // namespace

DisturbanceObserver::DisturbanceObserver(const Gains& gains) noexcept : period_s_(gains.period_s) {
  for (std::size_t i = 0; i < gains_.size(); ++i) {
    gains_[i] = observer_gains(gains.bandwidth_rad_per_s, gains.velocity_bandwidth_rad_per_s,
                               static_cast<double>(i + 1) * gains.period_s);
  }
  const double delay = std::clamp(gains.loop_delay, 0.0, static_cast<double>(kMaxLoopDelay));
  whole_delay_ = static_cast<std::size_t>(delay);
  part_delay_ = delay - static_cast<double>(whole_delay_);
  accelerations_.fill(Vec3::Zero());
}

void DisturbanceObserver::reset(const Vec3& joints_m) noexcept {
  q_ = joints_m;
  missed_ = 0;
  v_.setZero();
  w_.setZero();
  disturbance_n_.setZero();
  accelerations_.fill(Vec3::Zero());
}

void DisturbanceObserver::applied(const Vec3& force_n, const Mat3& nominal_inertia_kg) noexcept {
  nominal_inertia_kg_ = nominal_inertia_kg;
  for (std::size_t i = accelerations_.size() - 1; i > 0; --i) accelerations_[i] = accelerations_[i - 1];
  accelerations_[0] = nominal_inertia_kg.inverse() * force_n;
}

void DisturbanceObserver::predict() noexcept {
  const double t = period_s_;
  // Over the last period acted first what was older still, then the force of `loop_delay` samples ago.
  const double before_s = part_delay_ * t;
  if (before_s > 0.0) move(q_, v_, accelerations_[whole_delay_ + 1] + w_, before_s);
  move(q_, v_, accelerations_[whole_delay_] + w_, t - before_s);
  missed_ = std::min(missed_ + 1, kLongestGap);
  disturbance_n_ = -nominal_inertia_kg_ * w_;
}

void DisturbanceObserver::correct(const Vec3& measured_joints_m) noexcept {
  const ObserverGains& gains = gains_[missed_ - 1];
  const double apart_s = static_cast<double>(missed_) * period_s_;
  const Vec3 innovation = measured_joints_m - q_;
  q_ += gains.alpha * innovation;
  v_ += gains.beta / apart_s * innovation;
  w_ += gains.gamma / (apart_s * apart_s) * innovation;
  missed_ = 0;
  disturbance_n_ = -nominal_inertia_kg_ * w_;
}

DisturbanceObserver::Ahead DisturbanceObserver::ahead() const noexcept {
  Ahead out{q_, v_};
  if (part_delay_ > 0.0)
    move(out.joints_m, out.velocity_m_per_s, accelerations_[whole_delay_] + w_, part_delay_ * period_s_);
  for (std::size_t i = whole_delay_; i-- > 0;)
    move(out.joints_m, out.velocity_m_per_s, accelerations_[i] + w_, period_s_);
  return out;
}

}  // namespace telekerf::control
