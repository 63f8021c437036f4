// SPDX-License-Identifier: Apache-2.0
#include "common/robot/hall_calibration.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/robot/hall_channels.h"

namespace telekerf::robot {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using std::numbers::pi;

double wrapped(double angle) noexcept { return std::remainder(angle, 2 * pi); }

/// Of a symmetric positive definite matrix. Two rows are tridiagonal as they are, so that Eigen's reduction
/// to that form, which takes most of this file's time to compile, is not needed.
Eigen::Matrix2d square_root(const Eigen::Matrix2d& m) {
  const double scale = m.cwiseAbs().maxCoeff();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeFromTridiagonal(m.diagonal() / scale, m.diagonal<-1>() / scale);
  const Eigen::Matrix2d& v = axes.eigenvectors();
  return v * (scale * axes.eigenvalues()).cwiseSqrt().asDiagonal() * v.transpose();
}

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
  // Points of half a turn leave the conic undetermined: the sweep is too short. The smallest eigenvalue is
  // above a bound exactly if the matrix less that bound is positive definite.
  const Eigen::MatrixXd above =
      gram - 1e-3 * static_cast<double>(points.size()) * Eigen::MatrixXd::Identity(5, 5);
  if (!(above.ldlt().vectorD().minCoeff() > 0)) return std::nullopt;
  const Eigen::VectorXd c = gram.ldlt().solve(right);
  Eigen::Matrix2d q;
  q << c[0], 0.5 * c[1], 0.5 * c[1], c[2];
  if (!(q.determinant() > 0) || !(c[0] > 0)) return std::nullopt;
  Circle circle;
  circle.centre = -0.5 * q.inverse() * Vector2d(c[3], c[4]);
  const double level = 1 + circle.centre.dot(q * circle.centre);
  circle.map = square_root(q / level);
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
