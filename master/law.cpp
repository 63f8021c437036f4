// SPDX-License-Identifier: Apache-2.0
#include "master/law.h"

#include <algorithm>
#include <cmath>

#include "common/control/tracking_law.h"

namespace telekerf::master {

double law_bandwidth(const LawSettings& settings, double delay_s) noexcept {
  if (settings.law != Law::kRemoteAcceleration) return settings.tracking_rad_s;
  const double w = (std::sqrt(1.0 + 0.5 * delay_s / settings.timing_error_s) - 1.0) / delay_s;
  return std::min(settings.tracking_rad_s, w);
}

Vec3 commanded_acceleration(const LawSettings& settings, double bandwidth_rad_s, const KinematicState& goal,
                            const KinematicState& slave, const Vec3& disturbance_m_per_s2) noexcept {
  const Vec3 wanted = control::tracking_acceleration(goal, slave, bandwidth_rad_s) - disturbance_m_per_s2;
  const Vec3 command = control::limited(wanted, settings.max_acceleration_m_per_s2);
  return command.allFinite() ? command : Vec3(Vec3::Zero());
}

}  // namespace telekerf::master
