// SPDX-License-Identifier: Apache-2.0
// A wall for one coordinate: it sets in over a skin, is critically damped and never holds back.
#pragma once

#include <algorithm>

namespace telekerf::master {

/// Acceleration that the wall leaves of `a`, both positive into the wall; `depth` > 0: inside it.
/// `w`: its bandwidth, rad/s.
inline double walled(double a, double depth, double depth_rate, double skin_m, double w) noexcept {
  if (depth <= 0.0) return a;
  const double u = std::min(depth / skin_m, 1.0);
  const double share = u * u * (3.0 - 2.0 * u);
  const double wall = -w * w * depth - 2.0 * w * depth_rate;
  return std::min(a, (1.0 - share) * a + share * wall);
}

}  // namespace telekerf::master
