// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/ridge.h"

#include <cmath>

namespace telekerf::imaging {
namespace {

/// What a lock is off the quadratic, m: errors of locks are a tenth of it, the rest is the ridge's true
/// shape.
constexpr double kLockDeviation_m = 0.2e-3;
/// How far height, slope and bend may be off the model, m.
constexpr double kUnknown_m[] = {1e-2, 3e-3, 2e-3};

}  // namespace

RidgeEstimate::RidgeEstimate(const ImagingModel& model)
    : travel_m_(model.magnification_travel_m),
      coefficients_m_(model.ridge_m[0], model.ridge_m[1], model.ridge_m[2]),
      covariance_m2_(Eigen::Vector3d(kUnknown_m[0], kUnknown_m[1], kUnknown_m[2]).cwiseAbs2().asDiagonal()) {}

Eigen::Vector3d RidgeEstimate::terms(double magnification_axis_m) const {
  const double s = magnification_axis_m / travel_m_;
  return {1.0, s, s * s};
}

void RidgeEstimate::learn(const AxisPositions& lock) {
  const Eigen::Vector3d phi = terms(lock.magnification_m);
  const Eigen::Vector3d spread = covariance_m2_ * phi;
  const double innovation_m2 = phi.dot(spread) + kLockDeviation_m * kLockDeviation_m;
  coefficients_m_ += spread / innovation_m2 * (lock.focus_m - phi.dot(coefficients_m_));
  covariance_m2_ -= spread * spread.transpose() / innovation_m2;
  ++locks_;
}

RidgeEstimate::Prediction RidgeEstimate::at(double magnification_axis_m) const {
  const Eigen::Vector3d phi = terms(magnification_axis_m);
  return {phi.dot(coefficients_m_), std::sqrt(std::max(0.0, phi.dot(covariance_m2_ * phi)))};
}

void RidgeEstimate::write_to(ImagingModel& model) const {
  for (std::size_t i = 0; i < 3; ++i) model.ridge_m[i] = coefficients_m_[static_cast<Eigen::Index>(i)];
}

}  // namespace telekerf::imaging
