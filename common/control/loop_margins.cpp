// SPDX-License-Identifier: Apache-2.0
#include "common/control/loop_margins.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "common/control/disturbance_observer.h"
#include "common/control/tracking_law.h"

namespace telekerf::control {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// x' = A x + B y, u = C x + D y.
struct LinearSystem {
  MatrixXd a;
  VectorXd b;
  RowVectorXd c;
  double d = 0.0;

  std::complex<double> at(std::complex<double> z) const {
    const Eigen::MatrixXcd zi_a =
        z * Eigen::MatrixXcd::Identity(a.rows(), a.cols()) - a.cast<std::complex<double>>();
    const Eigen::VectorXcd x = zi_a.partialPivLu().solve(b.cast<std::complex<double>>());
    return (c.cast<std::complex<double>>() * x)(0) + d;
  }
};

/// Rows that move position and velocity (rows 0 and 1 of `state`) on by `h_s` under the acceleration `by`.
void move(MatrixXd& state, const RowVectorXd& by, double h_s) {
  state.row(0) += h_s * state.row(1) + 0.5 * h_s * h_s * by;
  state.row(1) += h_s * by;
}

struct Delay {
  Eigen::Index whole;
  double part;
};
Delay delay_of(const LoopConditions& conditions) {
  const double samples =
      std::clamp(conditions.delay_s / conditions.period_s, 0.0, static_cast<double>(kMaxLoopDelay));
  return {static_cast<Eigen::Index>(samples), samples - std::floor(samples)};
}

/// A joint of unit nominal inertia from the acceleration asked for to the reading.
LinearSystem plant(const LoopConditions& conditions, double inertia_ratio) {
  const auto [whole, part] = delay_of(conditions);
  const double t = conditions.period_s;
  const Eigen::Index n = 3 + whole;  // q, v, and the accelerations of the steps before, newest first
  LinearSystem out{MatrixXd::Zero(n, n), VectorXd::Zero(n), RowVectorXd::Zero(n), 0.0};
  MatrixXd rows = MatrixXd::Zero(2, n + 1);  // the last column is the newest acceleration
  rows(0, 0) = rows(1, 1) = 1.0;
  const auto acceleration = [&](Eigen::Index steps_ago) {
    RowVectorXd row = RowVectorXd::Zero(n + 1);
    row(steps_ago == 0 ? n : 1 + steps_ago) = 1.0 / inertia_ratio;
    return row;
  };
  move(rows, acceleration(whole + 1), part * t);
  move(rows, acceleration(whole), (1.0 - part) * t);
  out.a.topRows(2) = rows.leftCols(n);
  out.b.head(2) = rows.col(n);
  out.b(2) = 1.0;
  for (Eigen::Index i = 3; i < n; ++i) out.a(i, i - 1) = 1.0;
  out.c(0) = 1.0;
  return out;
}

/// Observer and law, from the reading to the acceleration asked for; as DisturbanceObserver computes them.
LinearSystem controller(const LoopConditions& conditions, const LoopBandwidths& bandwidths) {
  const auto [whole, part] = delay_of(conditions);
  const double t = conditions.period_s;
  const ObserverGains gains = observer_gains(bandwidths.observer_rad_per_s, bandwidths.velocity_rad_per_s, t);
  const SampledGains law = sampled_gains(bandwidths.law_rad_per_s, 1.0, t);
  const Eigen::Index n = 5 + whole;  // q, v, w, and the accelerations of the steps before, newest first
  MatrixXd state = MatrixXd::Zero(3, n + 1);  // the last column is the reading
  state(0, 0) = state(1, 1) = state(2, 2) = 1.0;
  const auto total = [&](Eigen::Index steps_ago) {
    RowVectorXd row = state.row(2);
    row(2 + steps_ago) += 1.0;
    return row;
  };
  if (part > 0.0) move(state, total(whole + 2), part * t);
  move(state, total(whole + 1), (1.0 - part) * t);
  RowVectorXd innovation = -state.row(0);
  innovation(n) += 1.0;
  state.row(0) += gains.alpha * innovation;
  state.row(1) += gains.beta / t * innovation;
  state.row(2) += gains.gamma / (t * t) * innovation;
  LinearSystem out{MatrixXd::Zero(n, n), VectorXd::Zero(n), RowVectorXd::Zero(n), 0.0};
  out.a.topRows(3) = state.leftCols(n);
  out.b.head(3) = state.col(n);
  // Where the answer acts.
  if (part > 0.0) move(state, total(whole + 1), part * t);
  for (Eigen::Index i = whole; i >= 1; --i) move(state, total(i), t);
  const RowVectorXd u = -law.position * state.row(0) - law.velocity * state.row(1) - state.row(2);
  out.c = u.leftCols(n);
  out.d = u(n);
  out.a.row(3) = out.c;
  out.b(3) = out.d;
  for (Eigen::Index i = 4; i < n; ++i) out.a(i, i - 1) = 1.0;
  return out;
}

bool stable(const LinearSystem& plant, const LinearSystem& control) {
  const Eigen::Index p = plant.a.rows();
  const Eigen::Index c = control.a.rows();
  MatrixXd loop(p + c, p + c);
  loop << plant.a + plant.b * control.d * plant.c, plant.b * control.c, control.b * plant.c, control.a;
  return loop.eigenvalues().cwiseAbs().maxCoeff() < 1.0;
}

}  // namespace

LoopMargins loop_margins(const LoopConditions& conditions, const LoopBandwidths& bandwidths,
                         double inertia_ratio) {
  const LinearSystem joint = plant(conditions, inertia_ratio);
  const LinearSystem control = controller(conditions, bandwidths);
  LoopMargins out;
  out.stable = stable(joint, control);
  if (!out.stable) return out;
  constexpr int kFrequencies = 160;
  double power = 0.0;  // integral of |K S|^2 over the angle, 0..pi
  double shake = 0.0;  // the same of |K S T / (z - 1)|^2
  double last_angle = 0.0;
  for (int i = 0; i < kFrequencies; ++i) {
    // From a thousandth of the Nyquist frequency, evenly in its logarithm.
    const double angle = std::numbers::pi * std::pow(1e-3, 1.0 - (i + 0.5) / kFrequencies);
    const std::complex<double> z = std::polar(1.0, angle);
    const std::complex<double> k = control.at(z);
    const std::complex<double> s = 1.0 / (1.0 - joint.at(z) * k);
    out.max_sensitivity = std::max(out.max_sensitivity, std::abs(s));
    power += std::norm(k * s) * (angle - last_angle);
    shake += std::norm(k * s * conditions.period_s / (z - 1.0)) * (angle - last_angle);
    last_angle = angle;
  }
  out.noise_m_per_s2 = conditions.noise_m * std::sqrt(power / std::numbers::pi);
  out.noise_m_per_s = conditions.noise_m * std::sqrt(shake / std::numbers::pi);
  return out;
}

}  // namespace telekerf::control
