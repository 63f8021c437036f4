// SPDX-License-Identifier: Apache-2.0
#include "common/robot/hall_sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/robot/hall_channels.h"

namespace telekerf::robot {

using Eigen::Vector2d;
using std::numbers::pi;

HallSensor::HallSensor(const Sensor& sensor, std::uint64_t seed) : sensor_(sensor), random_(seed) {
  const auto spread = [&] { return 2 * static_cast<double>(random_() >> 11) * 0x1p-53 - 1; };
  for (std::size_t k = 0; k < 3; ++k) {
    gain_[k] = 1 + sensor.gain_mismatch * spread();
    offset_[k] = sensor.offset_mismatch * spread();
    phase_rad_[k] = kNominalPhase[k] + sensor.phase_mismatch_rad * spread();
  }
}

double HallSensor::noise() noexcept {
  if (sensor_.noise == 0) return 0;
  // Box and Muller; std::normal_distribution differs between libraries.
  const double u = (static_cast<double>(random_() >> 11) + 1) * 0x1p-53;
  const double v = static_cast<double>(random_() >> 11) * 0x1p-53;
  return sensor_.noise * std::sqrt(-2 * std::log(u)) * std::cos(2 * pi * v);
}

HallCounts HallSensor::sample(double position_m, double velocity_m_per_s) noexcept {
  const double scale = volts_per_count(sensor_.adc_bits);
  const double limit = std::ldexp(1.0, sensor_.adc_bits - 1);
  HallCounts counts{};
  for (int i = sensor_.conversions - 1; i >= 0; --i) {
    const double phi = 2 * pi * (position_m - i * sensor_.conversion_s * velocity_m_per_s) / sensor_.pitch_m;
    for (std::size_t k = 0; k < 3; ++k) {
      const double u = gain_[k] * std::sin(phi + phase_rad_[k]) + offset_[k] + noise();
      counts[k] += std::clamp(std::round(u / scale), -limit, limit - 1) / sensor_.conversions;
    }
  }
  return counts;
}

HallDecoder::HallDecoder(double pitch_m, int adc_bits, const HallCalibration& calibration) noexcept
    : pitch_m_(pitch_m),
      volts_per_count_(volts_per_count(adc_bits)),
      offset_(calibration.offset),
      to_sin_cos_(sin_cos_map(calibration)) {}

double HallDecoder::update(const HallCounts& counts) noexcept {
  const Vector2d sin_cos = to_sin_cos_ * (volts(counts, volts_per_count_) - offset_);
  amplitude_ = sin_cos.norm();
  double phi = std::atan2(sin_cos.x(), sin_cos.y());  // eq. 153, in (-pi, pi]
  if (phi < 0) phi += 2 * pi;
  if (started_) {
    if (phi - phi_rad_ > pi) --cycles_;
    if (phi - phi_rad_ < -pi) ++cycles_;
  }
  started_ = true;
  phi_rad_ = phi;
  position_m_ = origin_m_ + pitch_m_ * (static_cast<double>(cycles_) + phi / (2 * pi));
  return position_m_;
}

}  // namespace telekerf::robot
