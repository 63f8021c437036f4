// SPDX-License-Identifier: Apache-2.0
#include "common/control/bumpless_transfer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace telekerf::control {

void BumplessTransfer::start(const KinematicState& from, const KinematicState& source) noexcept {
  offset_ = from.position_m - source.position_m;
  offset_rate_ = from.velocity_m_per_s - source.velocity_m_per_s;
  rate_ = rate_for(offset_.norm(), offset_rate_.norm());
}

double BumplessTransfer::rate_for(double size_m, double speed_m_per_s) const noexcept {
  // The fade asks for -2 w o' - w^2 o: neither part is more than the acceleration allowed.
  const double limit = settings_.max_acceleration_m_per_s2;
  return std::min({settings_.rate_rad_per_s, std::sqrt(limit / std::max(size_m, 1e-9)),
                   0.5 * limit / std::max(speed_m_per_s, 1e-9)});
}

double BumplessTransfer::way_to_rest_m(double speed_m_per_s) const noexcept {
  // o' t e^(-w t) is largest at t = 1 / w.
  return speed_m_per_s / (std::numbers::e * rate_for(0.0, speed_m_per_s));
}

KinematicState BumplessTransfer::apply(const KinematicState& source, double dt_s) noexcept {
  // Exact solution of the critically damped fade over one step: (o + (o' + w o) t) e^(-w t).
  const double fade = std::exp(-rate_ * dt_s);
  const Eigen::Vector3d slope = offset_rate_ + rate_ * offset_;
  offset_ = fade * (offset_ + slope * dt_s);
  offset_rate_ = fade * slope - rate_ * offset_;
  KinematicState out = source;
  out.position_m += offset_;
  out.velocity_m_per_s += offset_rate_;
  out.acceleration_m_per_s2 -= 2.0 * rate_ * offset_rate_ + rate_ * rate_ * offset_;
  return out;
}

}  // namespace telekerf::control
