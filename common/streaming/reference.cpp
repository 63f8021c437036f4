// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/reference.h"

#include <Eigen/LU>
#include <cmath>

namespace telekerf::slave {

std::optional<KinematicState> reference_at(const JitterBuffer& ring, double cursor,
                                           double period_s) noexcept {
  const auto centre = static_cast<std::int64_t>(std::llround(cursor));
  const StreamSample* middle = ring.find(centre);
  if (middle == nullptr) return std::nullopt;

  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();  // row: power, column: axis
  int used = 0;
  const auto include = [&](std::int64_t index) {
    const StreamSample* sample = ring.find(index);
    if (sample == nullptr || sample->generation != middle->generation) return false;
    if (sample->engaged != middle->engaged) return false;  // the master may have been moved elsewhere
    const double n = static_cast<double>(index - centre);
    const Eigen::Vector3d powers(1.0, n, n * n);
    normal += powers * powers.transpose();
    moments += powers * (sample->value - middle->value).transpose();
    ++used;
    return true;
  };
  include(centre);
  for (int k = 1; k <= kHalfWindow && include(centre - k); ++k) {
  }
  for (int k = 1; k <= kHalfWindow && include(centre + k); ++k) {
  }

  KinematicState motion;
  motion.position_m = middle->value;
  if (used < 4) return motion;
  const Eigen::Matrix3d fit = normal.inverse() * moments;  // rows: value, slope, half curvature
  const double t = cursor - static_cast<double>(centre);
  motion.position_m += (fit.row(0) + t * fit.row(1) + t * t * fit.row(2)).transpose();
  motion.velocity_m_per_s = (fit.row(1) + 2.0 * t * fit.row(2)).transpose() / period_s;
  motion.acceleration_m_per_s2 = 2.0 * fit.row(2).transpose() / (period_s * period_s);
  return motion;
}

void bridge_gap(JitterBuffer& ring, std::int64_t index, double period_s, int reach,
                double most_m_per_s2) noexcept {
  const auto known = [&](std::int64_t at) {
    const StreamSample* sample = ring.find(at);
    return sample != nullptr && !sample->bridged;
  };
  std::int64_t before = index;
  while (!known(before) && index - before < reach) --before;
  std::int64_t after = index;
  while (!known(after) && after - before <= reach) ++after;
  if (!known(before) || !known(after)) return;
  const StreamSample from = *ring.find(before);
  const StreamSample to = *ring.find(after);
  if (!from.engaged || !to.engaged || from.generation != to.generation || from.law != to.law) return;

  const double duration = static_cast<double>(after - before) * period_s;
  const Vec3 way = (to.value - from.value) / duration;
  // p(u) = p0 + T (v0 u + b u^2 + c u^3); its acceleration is largest at an end.
  const Vec3 b = 3.0 * way - 2.0 * from.velocity_m_per_s - to.velocity_m_per_s;
  const Vec3 c = from.velocity_m_per_s + to.velocity_m_per_s - 2.0 * way;
  const double most = most_m_per_s2 * duration;
  const bool bare = from.law == Law::kRemoteAcceleration;  // no states, nothing but accelerations
  if (!bare && (!((2.0 * b).norm() <= most) || !((2.0 * b + 6.0 * c).norm() <= most))) return;
  for (std::int64_t at = before + 1; at < after; ++at) {
    const double u = static_cast<double>(at - before) * period_s / duration;
    StreamSample sample = from;
    sample.bridged = true;
    sample.button = false;
    if (bare) {
      sample.acceleration_m_per_s2 += u * (to.acceleration_m_per_s2 - from.acceleration_m_per_s2);
    } else {
      sample.value += duration * u * (from.velocity_m_per_s + u * (b + u * c));
      sample.velocity_m_per_s += u * (2.0 * b + 3.0 * u * c);
      sample.acceleration_m_per_s2 = (2.0 * b + 6.0 * u * c) / duration;
    }
    ring.store(at, sample);
  }
}

}  // namespace telekerf::slave
