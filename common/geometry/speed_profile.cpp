// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/speed_profile.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace telekerf::geometry {
namespace {

/// v^2 of the second may be that of the first and `growth`.
void limit(double first, double& second, double growth) noexcept {
  second = std::min(second, std::sqrt(first * first + growth));
}

}  // namespace

double speed_in_bend(double curvature_per_m, double acceleration_m_per_s2) noexcept {
  return std::sqrt(acceleration_m_per_s2 / std::abs(curvature_per_m));
}

void keep_brakable(std::span<double> speed, double step_m, double acceleration_m_per_s2) noexcept {
  const double growth = 2.0 * acceleration_m_per_s2 * step_m;
  for (std::size_t i = speed.size(); i-- > 1;) limit(speed[i], speed[i - 1], growth);
}

void keep_brakable_both_ways(std::span<double> speed, double step_m, double acceleration_m_per_s2,
                             bool closed) noexcept {
  const double growth = 2.0 * acceleration_m_per_s2 * step_m;
  const std::size_t n = speed.size();
  if (n < 2) return;
  // A closed line twice round, so that the place where it begins is seen from both sides.
  const std::size_t steps = closed ? 2 * n : n - 1;
  for (std::size_t i = 0; i < steps; ++i) limit(speed[i % n], speed[(i + 1) % n], growth);
  for (std::size_t i = steps; i > 0; --i) limit(speed[i % n], speed[(i - 1) % n], growth);
}

}  // namespace telekerf::geometry
