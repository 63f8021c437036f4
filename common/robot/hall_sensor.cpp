// SPDX-License-Identifier: Apache-2.0
#include "common/robot/hall_sensor.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace telekerf::robot {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr std::array<double, 3> kNominalPhase{0, 2 * pi / 3, -2 * pi / 3};

double volts_per_count(int adc_bits) noexcept { return kHallFullScale / std::ldexp(1.0, adc_bits - 1); }

Vector3d volts(const HallCounts& counts, double scale) noexcept {
  return scale * Vector3d(counts[0], counts[1], counts[2]);
}

/// Left inverse of [a b] in u - o = [a b] (sin, cos)^T; Clarke's transformation for nominal channels.
Eigen::Matrix<double, 2, 3> sin_cos_map(const HallCalibration& calibration) noexcept {
  Eigen::Matrix<double, 3, 2> channels;
  for (int k = 0; k < 3; ++k) {
    const double phase = kNominalPhase[static_cast<std::size_t>(k)] + calibration.phase_rad[k];
    channels.row(k) << calibration.gain[k] * std::cos(phase), calibration.gain[k] * std::sin(phase);
  }
  const Eigen::Matrix2d gram = channels.transpose() * channels;
  return gram.inverse() * channels.transpose();
}

double wrapped(double angle) noexcept { return std::remainder(angle, 2 * pi); }

/// Centre and symmetric map that turn the points' ellipse x' Q x + l' x = 1 into the unit circle.
struct Circle {
  Vector2d centre;
  Eigen::Matrix2d map;
};

std::optional<Circle> circle_through(const std::vector<Vector2d>& points) {
  // Sizes known at compile time would be unrolled into half a minute of compiling.
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(5, 5);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(5);
  Eigen::VectorXd row(5);
  for (const auto& p : points) {
    row << p.x() * p.x(), p.x() * p.y(), p.y() * p.y(), p.x(), p.y();
    gram += row * row.transpose();
    right += row;
  }
  // Points of half a turn leave the conic undetermined: the sweep is too short.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(gram);
  if (!(spectrum.eigenvalues()[0] > 1e-3 * static_cast<double>(points.size()))) return std::nullopt;
  const Eigen::VectorXd c = gram.ldlt().solve(right);
  Eigen::Matrix2d q;
  q << c[0], 0.5 * c[1], 0.5 * c[1], c[2];
  if (!(q.determinant() > 0) || !(c[0] > 0)) return std::nullopt;
  Circle circle;
  circle.centre = -0.5 * q.inverse() * Vector2d(c[3], c[4]);
  const double level = 1 + circle.centre.dot(q * circle.centre);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(q / level);
  circle.map = axes.operatorSqrt();
  return circle;
}

/// Least squares of each channel on [1, sin phi, cos phi]; the common phase is taken out.
HallCalibration fit_channels(const std::vector<Vector3d>& sweep, const std::vector<double>& phi) {
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d right = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    const Vector3d row(1, std::sin(phi[i]), std::cos(phi[i]));
    gram += row * row.transpose();
    right += row * sweep[i].transpose();
  }
  const Eigen::Matrix3d fit = gram.ldlt().solve(right);
  HallCalibration calibration;
  for (int k = 0; k < 3; ++k) {
    calibration.offset[k] = fit(0, k);
    calibration.gain[k] = std::hypot(fit(1, k), fit(2, k));
    calibration.phase_rad[k] =
        wrapped(std::atan2(fit(2, k), fit(1, k)) - kNominalPhase[static_cast<std::size_t>(k)]);
  }
  const double common = calibration.phase_rad.mean();
  calibration.phase_rad.array() -= common;
  return calibration;
}

}  // namespace

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

HallCounts HallSensor::sample(double position_m) noexcept {
  const double phi = 2 * pi * position_m / sensor_.pitch_m;
  const double scale = volts_per_count(sensor_.adc_bits);
  const double limit = std::ldexp(1.0, sensor_.adc_bits - 1);
  HallCounts counts;
  for (std::size_t k = 0; k < 3; ++k) {
    const double u = gain_[k] * std::sin(phi + phase_rad_[k]) + offset_[k] + noise();
    counts[k] = static_cast<std::int32_t>(std::clamp(std::round(u / scale), -limit, limit - 1));
  }
  return counts;
}

std::optional<HallCalibration> calibrate_hall(std::span<const HallCounts> sweep, int adc_bits) {
  constexpr std::size_t kFewest = 16;
  if (sweep.size() < kFewest) return std::nullopt;
  const double scale = volts_per_count(adc_bits);
  const auto clarke = sin_cos_map({});
  std::vector<Vector3d> measured;
  std::vector<Vector2d> vectors;
  for (const auto& counts : sweep) {
    measured.push_back(volts(counts, scale));
    vectors.emplace_back(clarke * measured.back());
  }
  const auto circle = circle_through(vectors);
  if (!circle) return std::nullopt;
  std::vector<double> phi;
  for (const auto& v : vectors) {
    const Vector2d unit = circle->map * (v - circle->centre);
    phi.push_back(std::atan2(unit.x(), unit.y()));
  }
  HallCalibration calibration = fit_channels(measured, phi);
  // Once more with the least-squares map of all three channels, which averages their noise.
  const auto map = sin_cos_map(calibration);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const Vector2d sc = map * (measured[i] - calibration.offset);
    phi[i] = std::atan2(sc.x(), sc.y());
  }
  return fit_channels(measured, phi);
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

HallAccuracy hall_accuracy(const Sensor& spec, double path_m, std::uint64_t seed, bool calibrated) {
  constexpr int kSamples = 4000;
  HallSensor sensor(spec, seed);
  std::vector<HallCounts> sweep;
  sweep.reserve(kSamples);
  for (int i = 0; i < kSamples; ++i) sweep.push_back(sensor.sample(2 * spec.pitch_m * i / kSamples));
  const auto calibration = calibrated ? calibrate_hall(sweep, spec.adc_bits) : std::nullopt;
  HallDecoder decoder(spec.pitch_m, spec.adc_bits, calibration.value_or(HallCalibration{}));
  decoder.update(sensor.sample(0));
  decoder.home(0);
  std::vector<double> errors;
  double mean = 0;
  for (int i = 0; i <= 2 * kSamples; ++i) {
    const double share = 1 - std::abs(1 - static_cast<double>(i) / kSamples);
    errors.push_back(decoder.update(sensor.sample(share * path_m)) - share * path_m);
    mean += errors.back() / (2 * kSamples + 1);
  }
  HallAccuracy accuracy;
  for (const double error : errors) {
    accuracy.worst_m = std::max(accuracy.worst_m, std::abs(error - mean));
    accuracy.rms_m += (error - mean) * (error - mean);
  }
  accuracy.rms_m = std::sqrt(accuracy.rms_m / static_cast<double>(errors.size()));
  return accuracy;
}

}  // namespace telekerf::robot
