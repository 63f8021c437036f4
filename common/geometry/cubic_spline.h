// SPDX-License-Identifier: Apache-2.0
// C2 cubic splines through samples in time: position, velocity, acceleration and jerk (thesis 3.2.4, eq.
// 11-14).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace telekerf::geometry {

enum class SplineEnds {
  kNotAKnot,  ///< one cubic over the first two and the last two intervals: reproduces cubics
  kAtRest,    ///< zero velocity at both ends
  kPeriodic,  ///< the last value equals the first and so do the derivatives
};

/// Second derivatives at the knots of the C2 spline through `values` (one row a knot, one column an axis).
/// Errors: fewer than two knots (three for a periodic one), times that do not increase, values not finite.
tl::expected<Eigen::MatrixXd, std::string> spline_second_derivatives(const std::vector<double>& times_s,
                                                                     const Eigen::MatrixXd& values,
                                                                     SplineEnds ends);

/// A spline in N axes; evaluation is real-time code.
template <int N>
class CubicSpline {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;
  struct State {
    Vector position = Vector::Zero();
    Vector velocity = Vector::Zero();
    Vector acceleration = Vector::Zero();
    Vector jerk = Vector::Zero();
  };

  static tl::expected<CubicSpline, std::string> through(const std::vector<double>& times_s,
                                                        const std::vector<Vector>& values,
                                                        SplineEnds ends = SplineEnds::kNotAKnot) {
    Eigen::MatrixXd rows(values.size(), N);
    for (std::size_t i = 0; i < values.size(); ++i)
      rows.row(static_cast<Eigen::Index>(i)) = values[i].transpose();
    const auto second = spline_second_derivatives(times_s, rows, ends);
    if (!second) return tl::unexpected(second.error());
    CubicSpline out;
    out.times_s_ = times_s;
    for (std::size_t i = 0; i + 1 < values.size(); ++i) {
      const double h = out.times_s_[i + 1] - out.times_s_[i];
      const Vector m0 = second->row(static_cast<Eigen::Index>(i)).transpose();
      const Vector m1 = second->row(static_cast<Eigen::Index>(i) + 1).transpose();
      out.pieces_.push_back({(m1 - m0) / (6.0 * h), 0.5 * m0,
                             (values[i + 1] - values[i]) / h - h / 6.0 * (2.0 * m0 + m1), values[i]});
    }
    return out;
  }

  double start_s() const noexcept { return times_s_.front(); }
  double end_s() const noexcept { return times_s_.back(); }

  /// Beyond its ends the spline holds the end's value with zero derivatives.
  State at(double time_s) const noexcept {
    State out;
    const auto above = std::upper_bound(times_s_.begin() + 1, times_s_.end() - 1, time_s);
    const auto i = static_cast<std::size_t>(above - times_s_.begin()) - 1;
    const double t = std::clamp(time_s, start_s(), end_s()) - times_s_[i];
    const Piece& p = pieces_[i];
    out.position = ((p.a * t + p.b) * t + p.c) * t + p.d;  // eq. 11
    if (!(time_s >= start_s() && time_s <= end_s())) return out;
    out.velocity = (3.0 * p.a * t + 2.0 * p.b) * t + p.c;  // eq. 12
    out.acceleration = 6.0 * p.a * t + 2.0 * p.b;          // eq. 13
    out.jerk = 6.0 * p.a;                                  // eq. 14: constant within a piece
    return out;
  }

 private:
  struct Piece {
    Vector a, b, c, d;
  };
  std::vector<double> times_s_;
  std::vector<Piece> pieces_;
};

}  // namespace telekerf::geometry
