// SPDX-License-Identifier: Apache-2.0
// How far a joint reading is off its mean.
#pragma once

#include <cmath>
#include <numbers>

#include "common/robot/hall_sensor.h"
#include "common/robot/robot_model.h"

namespace telekerf::robot {

/// rms, m. Encoder: evenly spread over one count. Hall: noise and converter steps of three channels a third
/// of a period apart, sigma_phi = sqrt(2/3) sigma_u / A, less by the root of the conversions (of steps only
/// where the noise spreads them); what calibration leaves of mismatch is no noise.
inline double reading_noise_m(const Sensor& sensor) noexcept {
  const double step_rms = 1.0 / std::sqrt(12.0);
  if (sensor.kind == Sensor::Kind::kEncoder) return sensor.resolution_m * step_rms;
  const double step = kHallFullScale / std::ldexp(1.0, sensor.adc_bits - 1);
  const double mean = 1.0 / std::sqrt(sensor.conversions);
  const double converter = step * step_rms * (sensor.noise >= 0.5 * step ? mean : 1.0);
  return std::sqrt(2.0 / 3.0) * std::hypot(sensor.noise * mean, converter) * sensor.pitch_m /
         (2.0 * std::numbers::pi);
}

}  // namespace telekerf::robot
