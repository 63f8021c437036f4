// SPDX-License-Identifier: Apache-2.0
// Joint position from three analog Hall voltages (eq. 147-154): sensor model, decoder, calibration.
//
// Channel k: u_k = o_k + a_k sin(phi) + b_k cos(phi), phi = 2 pi d / pitch; nominally sin(phi + {0, 2/3,
// -2/3} pi). With two unknowns (sin, cos) and three channels the decoder is a least-squares map; for nominal
// channels that map is Clarke's (eq. 151-152). A gain mismatch of 1 % costs 9.5 um, an offset of 1 % 19 um:
// hence the calibration.
//
// Several conversions a reading: their noises are each other's strangers, so that the mean of n has 1/sqrt(n)
// of it, and it is (n - 1)/2 conversions old.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <random>

#include "common/robot/robot_model.h"

namespace telekerf::robot {

/// What the converter gives for the three channels: signed counts, whole ones or the mean of several
/// conversions.
using HallCounts = std::array<double, 3>;

/// Full scale of the converter, as a share of a channel's nominal amplitude.
inline constexpr double kHallFullScale = 1.25;

/// Three sensors at one motor, not quite alike (drawn from the seed), with noise and a converter.
class HallSensor {
 public:
  HallSensor(const Sensor& sensor, std::uint64_t seed);
  /// One reading of Sensor::conversions conversions, `velocity_m_per_s` meanwhile; the last at `position_m`.
  HallCounts sample(double position_m, double velocity_m_per_s = 0.0) noexcept;

 private:
  double noise() noexcept;

  Sensor sensor_;
  std::array<double, 3> gain_{};
  std::array<double, 3> offset_{};
  std::array<double, 3> phase_rad_{};
  std::mt19937_64 random_;
};

/// What differs from the nominal channels.
struct HallCalibration {
  Eigen::Vector3d gain = Eigen::Vector3d::Ones();       ///< amplitude, relative to nominal
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();     ///< as a share of the nominal amplitude
  Eigen::Vector3d phase_rad = Eigen::Vector3d::Zero();  ///< beyond {0, 2/3, -2/3} pi
};

/// Counts in, position out, unwrapped over any number of pitches while a sample moves less than half a pitch.
class HallDecoder {
 public:
  HallDecoder(double pitch_m, int adc_bits, const HallCalibration& calibration = {}) noexcept;

  /// Position in m; the first sample lies in [0, pitch) unless home() has said otherwise.
  double update(const HallCounts& counts) noexcept;
  /// The last sample was taken at this position.
  void home(double position_m) noexcept {
    origin_m_ += position_m - position_m_;
    position_m_ = position_m;
  }
  /// sqrt(sin^2 + cos^2) of the last sample: 1 when sensors and magnet are well.
  double amplitude() const noexcept { return amplitude_; }

 private:
  double pitch_m_;
  double volts_per_count_;
  Eigen::Vector3d offset_;
  Eigen::Matrix<double, 2, 3> to_sin_cos_;
  double origin_m_ = 0;
  double phi_rad_ = 0;
  std::int64_t cycles_ = 0;
  bool started_ = false;
  double position_m_ = 0;
  double amplitude_ = 0;
};

}  // namespace telekerf::robot
