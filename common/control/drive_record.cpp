// SPDX-License-Identifier: Apache-2.0
#include "common/control/drive_record.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace telekerf::control {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A symmetric low-pass of sum 1 whose gain is a half a bit above `half_gain_hz`; where that is beyond the
/// rate, 1 alone.
VectorXd low_pass(double period_s, double half_gain_hz) {
  const Index half = std::lround(0.25 / (half_gain_hz * period_s));
  VectorXd weights(2 * half + 1);
  for (Index i = -half; i <= half; ++i)
    weights[i + half] =
        1.0 + std::cos(std::numbers::pi * static_cast<double>(i) / static_cast<double>(half + 1));
  return weights / weights.sum();
}

/// Column by column; what lies too close to an end to be smoothed stays zero.
MatrixXd smoothed(const MatrixXd& values, const VectorXd& weights) {
  const Index half = weights.size() / 2;
  MatrixXd out = MatrixXd::Zero(values.rows(), values.cols());
  for (Index k = half; k + half < values.rows(); ++k)
    out.row(k) = weights.transpose() * values.middleRows(k - half, weights.size());
  return out;
}

/// Velocities, to the fourth order; noise is taken out of them far above the shaking alone, because friction
/// changes its sign exactly where they do.
VectorXd velocities(const VectorXd& place, double t, double highest_hz) {
  VectorXd v = VectorXd::Zero(place.size());
  for (Index k = 2; k + 2 < place.size(); ++k)
    v[k] = (8.0 * (place[k + 1] - place[k - 1]) - (place[k + 2] - place[k - 2])) / (12.0 * t);
  return smoothed(v, low_pass(t, 5.0 * highest_hz));
}

/// Viscous friction and the two shapes of dry friction, each its mean over the triangle of a second
/// difference, with velocities straight between the samples.
MatrixXd friction_shapes(const VectorXd& v, const robot::Friction& friction) {
  constexpr int kParts = 8;  // a period: dry friction changes within less than one
  MatrixXd out = MatrixXd::Zero(v.size(), 3);
  for (Index k = 1; k + 1 < v.size(); ++k) {
    for (int part = 1 - kParts; part < kParts; ++part) {
      const double away = std::abs(static_cast<double>(part)) / kParts;
      const double now = v[k] + away * (v[k + (part < 0 ? -1 : 1)] - v[k]);
      const double side = std::tanh(now / friction.smoothing_velocity_m_per_s);
      const double slow = now / friction.stribeck_velocity_m_per_s;
      out.row(k) += (1.0 - away) / kParts * Eigen::RowVector3d(now, side, side * std::exp(-slow * slow));
    }
  }
  return out;
}

}  // namespace

DriveRecord drive_record(std::span<const DriveSample> samples, const robot::Friction& friction,
                         double period_s, double highest_hz, Eigen::Index look_back) {
  const double t = period_s;
  constexpr Index kOthers = 4;  // a joint
  const auto n = static_cast<Index>(samples.size());
  MatrixXd asked(n, 3), measured = MatrixXd::Zero(n, 3), others = MatrixXd::Ones(n, 3 * kOthers + 1);
  for (int i = 0; i < 3; ++i) {
    VectorXd place(n);
    for (Index k = 0; k < n; ++k) {
      const DriveSample& sample = samples[static_cast<std::size_t>(k)];
      asked(k, i) = sample.acceleration_m_per_s2[i];
      place[k] = sample.joints_m[i] - samples.front().joints_m[i];
    }
    measured.col(i).segment(1, n - 2) =
        (place.tail(n - 2) - 2.0 * place.segment(1, n - 2) + place.head(n - 2)) / (t * t);
    others.middleCols(kOthers * i, 3) = friction_shapes(velocities(place, t, highest_hz), friction);
    others.col(kOthers * i + 3) = place;
  }
  const VectorXd weights = low_pass(t, highest_hz);
  DriveRecord record{smoothed(asked, weights), smoothed(measured, weights), smoothed(others, weights), {}};
  // Velocities and friction need some more to either side, and the delay looks back.
  const Index around = 2 * (weights.size() / 2) + 4;
  const Index first = std::max(around, look_back + weights.size() / 2);
  Index whole_since = 0;  // no reading is missing from here on
  for (Index k = 0; k < n; ++k) {
    if (!samples[static_cast<std::size_t>(k)].valid) whole_since = k + 1;
    const Index middle = k - around;
    if (middle >= first && middle - around >= whole_since) record.steps.push_back(middle);
  }
  return record;
}

}  // namespace telekerf::control
