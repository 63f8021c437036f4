// SPDX-License-Identifier: Apache-2.0
// From a converter's counts to sine and cosine: what decoder and calibration of the Hall sensors share.
#pragma once

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numbers>

#include "common/robot/hall_sensor.h"

namespace telekerf::robot {

inline constexpr std::array<double, 3> kNominalPhase{0, 2 * std::numbers::pi / 3, -2 * std::numbers::pi / 3};

inline double volts_per_count(int adc_bits) noexcept {
  return kHallFullScale / std::ldexp(1.0, adc_bits - 1);
}

inline Eigen::Vector3d volts(const HallCounts& counts, double scale) noexcept {
  return scale * Eigen::Vector3d(counts[0], counts[1], counts[2]);
}

/// Left inverse of [a b] in u - o = [a b] (sin, cos)^T; Clarke's transformation for nominal channels.
inline Eigen::Matrix<double, 2, 3> sin_cos_map(const HallCalibration& calibration) noexcept {
  Eigen::Matrix<double, 3, 2> channels;
  for (int k = 0; k < 3; ++k) {
    const double phase = kNominalPhase[static_cast<std::size_t>(k)] + calibration.phase_rad[k];
    channels.row(k) << calibration.gain[k] * std::cos(phase), calibration.gain[k] * std::sin(phase);
  }
  const Eigen::Matrix2d gram = channels.transpose() * channels;
  return gram.inverse() * channels.transpose();
}

}  // namespace telekerf::robot
