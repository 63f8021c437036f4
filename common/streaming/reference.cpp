// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/reference.h"

#include <Eigen/LU>
#include <cmath>

namespace telekerf::streaming {

std::optional<KinematicState> reference_at(const JitterBuffer& buffer, double cursor,
                                           double period_s) noexcept {
  const auto centre = static_cast<std::int64_t>(std::llround(cursor));
  const StreamSample* middle = buffer.find(centre);
  if (middle == nullptr) return std::nullopt;

  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();  // row: power, column: axis
  int used = 0;
  const auto include = [&](std::int64_t index) {
    const StreamSample* sample = buffer.find(index);
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

}  // namespace telekerf::streaming
