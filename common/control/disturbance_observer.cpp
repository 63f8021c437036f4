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

/// Of readings when a force comes or goes at once. The first is the work of a force since the reading before
/// at most, so that neither force nor velocity is overestimated; the second has all poles at 0.
constexpr ObserverGains kAtOnce[] = {{1.0, 2.0, 2.0}, {1.0, 1.5, 1.0}};
constexpr int kAbruptReadings = 2;
/// And readings after them that are answered as ever: whatever keeps coming is no hand that lets go, and a
/// robot that is far off its file must not be kept in motion by it.
constexpr int kUsualReadings = 100;

}  // namespace

DisturbanceObserver::DisturbanceObserver(const Gains& gains) noexcept
    : period_s_(gains.period_s), abrupt_(gains.abrupt), since_abrupt_(kAbruptReadings + kUsualReadings) {
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
  since_abrupt_ = kAbruptReadings + kUsualReadings;
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

const ObserverGains& DisturbanceObserver::gains_for(const Vec3& innovation_m) noexcept {
  since_abrupt_ = std::min(since_abrupt_ + 1, kAbruptReadings + kUsualReadings);
  if (since_abrupt_ == kAbruptReadings + kUsualReadings) {
    const double gap = static_cast<double>(missed_ * missed_);
    const double size_m = innovation_m.norm();
    if (size_m > gap * abrupt_.min_m && size_m < gap * abrupt_.max_m) since_abrupt_ = 0;
  }
  return since_abrupt_ < kAbruptReadings ? kAtOnce[since_abrupt_] : gains_[missed_ - 1];
}

void DisturbanceObserver::correct(const Vec3& measured_joints_m) noexcept {
  const Vec3 innovation = measured_joints_m - q_;
  const ObserverGains& gains = gains_for(innovation);
  const double apart_s = static_cast<double>(missed_) * period_s_;
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
