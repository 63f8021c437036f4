// SPDX-License-Identifier: Apache-2.0
#include "common/control/joiner.h"

#include <algorithm>
#include <cmath>

namespace telekerf::control {

void ReferenceJoiner::rejoin(const Motion& from, const Motion& source) noexcept {
  offset_ = from.position_m - source.position_m;
  offset_rate_ = from.velocity_m_per_s - source.velocity_m_per_s;
  const double size_m = std::max(offset_.norm(), 1e-9);
  rate_ = std::min(settings_.rate_rad_s, std::sqrt(settings_.max_acceleration_m_per_s2 / size_m));
}

Motion ReferenceJoiner::join(const Motion& source, double dt_s) noexcept {
  // Exact solution of the critically damped fade over one step: (o + (o' + w o) t) e^(-w t).
  const double fade = std::exp(-rate_ * dt_s);
  const Eigen::Vector3d slope = offset_rate_ + rate_ * offset_;
  offset_ = fade * (offset_ + slope * dt_s);
  offset_rate_ = fade * slope - rate_ * offset_;
  Motion out = source;
  out.position_m += offset_;
  out.velocity_m_per_s += offset_rate_;
  out.acceleration_m_per_s2 -= 2.0 * rate_ * offset_rate_ + rate_ * rate_ * offset_;
  return out;
}

}  // namespace telekerf::control
