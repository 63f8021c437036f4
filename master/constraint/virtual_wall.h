// SPDX-License-Identifier: Apache-2.0
// A wall for one coordinate: it sets in over a skin, is critically damped and never holds back.
#pragma once

#include <algorithm>

namespace telekerf::master {

/// Acceleration that the wall leaves of `a`, m/s^2, both positive into the wall; `depth_m` > 0: inside it.
/// `w`: its bandwidth, rad/s.
inline double virtual_wall_acceleration(double a, double depth_m, double depth_rate_m_per_s, double skin_m,
                                        double w) noexcept {
  if (depth_m <= 0.0) return a;
  const double u = std::min(depth_m / skin_m, 1.0);
  const double fraction = u * u * (3.0 - 2.0 * u);
  const double wall = -w * w * depth_m - 2.0 * w * depth_rate_m_per_s;
  return std::min(a, (1.0 - fraction) * a + fraction * wall);
}

}  // namespace telekerf::master
