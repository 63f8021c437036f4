// SPDX-License-Identifier: Apache-2.0
#include "master/constraint/speed_limits.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/circle_fit.h"
#include "common/geometry/speed_profile.h"
#include "master/constraint/guide_curve.h"

namespace telekerf::master {

SpeedLimits::SpeedLimits(const geometry::Polyline& line, double spacing_m, const ConstraintSettings& settings,
                         const std::function<double(double)>& curvature_at)
    : spacing_m_(spacing_m), segments_(line.segments()) {
  const auto n = static_cast<long>(line.size());
  std::vector<double> bends(static_cast<std::size_t>(n));  // signed curvature, of the larger of two
  for (long i = 0; i < n; ++i) {
    // Of the circle and of the points themselves: a circle through a cusp may be too flat.
    const double fraction = static_cast<double>(i) / static_cast<double>(line.segments());
    const Vec2 in = line.points_m[index_of(line, i)] - line.points_m[index_of(line, i - 2)];
    const Vec2 out = line.points_m[index_of(line, i + 2)] - line.points_m[index_of(line, i)];
    const double turn = 0.5 * std::atan2(geometry::cross(in, out), in.dot(out)) / spacing_m;
    const double circle = curvature_at(fraction);
    bends[static_cast<std::size_t>(i)] = std::abs(circle) > std::abs(turn) ? circle : turn;
  }
  limit_m_per_s_.resize(static_cast<std::size_t>(n));
  for (long i = 0; i < n; ++i) {
    const double bend = std::max(std::abs(bends[static_cast<std::size_t>(i)]), 1e-6);
    const double change =
        std::abs(bends[index_of(line, i + 2)] - bends[index_of(line, i - 2)]) / (4.0 * spacing_m);
    limit_m_per_s_[static_cast<std::size_t>(i)] =
        std::min({settings.max_speed_m_per_s, geometry::speed_in_bend(bend, settings.bend_m_per_s2),
                  settings.bend_rad_s / bend, std::cbrt(settings.bend_m_per_s3 / std::max(change, 1e-3))});
  }
  if (!line.closed) limit_m_per_s_.front() = limit_m_per_s_.back() = settings.end_m_per_s;
  geometry::keep_brakable_both_ways(limit_m_per_s_, spacing_m, settings.slowing_m_per_s2, line.closed);
}

SpeedLimit SpeedLimits::at(double fraction) const noexcept {
  const std::size_t n = limit_m_per_s_.size();
  const double place = fraction * static_cast<double>(segments_);
  const auto i = std::min(static_cast<std::size_t>(place), segments_ - 1);
  const double here = limit_m_per_s_[i];
  const double next = limit_m_per_s_[i + 1 < n ? i + 1 : 0];
  const double between = place - static_cast<double>(i);
  return {here + between * (next - here), (next - here) / spacing_m_};
}

}  // namespace telekerf::master
