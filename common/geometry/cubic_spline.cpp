// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/cubic_spline.h"

#include <cmath>

namespace telekerf::geometry {
namespace {

/// Thomas' algorithm for rows  lower[i] x[i-1] + main[i] x[i] + upper[i] x[i+1] = right[i]; diagonally
/// dominant here.
Eigen::MatrixXd solve_tridiagonal(const Eigen::VectorXd& lower, Eigen::VectorXd main,
                                  const Eigen::VectorXd& upper, Eigen::MatrixXd right) {
  const Eigen::Index n = main.size();
  for (Eigen::Index i = 1; i < n; ++i) {
    const double w = lower[i] / main[i - 1];
    main[i] -= w * upper[i - 1];
    right.row(i) -= w * right.row(i - 1);
  }
  right.row(n - 1) /= main[n - 1];
  for (Eigen::Index i = n - 2; i >= 0; --i)
    right.row(i) = (right.row(i) - upper[i] * right.row(i + 1)) / main[i];
  return right;
}

}  // namespace

tl::expected<Eigen::MatrixXd, std::string> spline_second_derivatives(const std::vector<double>& times_s,
                                                                     const Eigen::MatrixXd& values,
                                                                     SplineEnds ends) {
  const auto n = static_cast<Eigen::Index>(times_s.size());
  if (n != values.rows() || n < (ends == SplineEnds::kPeriodic ? 3 : 2)) {
    return tl::unexpected<std::string>(
        "a spline needs one time a value, and at least two (periodic: three) of them");
  }
  if (!values.allFinite()) return tl::unexpected<std::string>("a value of the spline is not finite");
  Eigen::VectorXd h(n - 1);
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    h[i] = times_s[i + 1] - times_s[i];
    if (!(h[i] > 0.0) || !std::isfinite(h[i]))
      return tl::unexpected<std::string>("the spline's times do not increase");
  }
  const Eigen::MatrixXd slope =
      (values.bottomRows(n - 1) - values.topRows(n - 1)).array().colwise() / h.array();
  Eigen::MatrixXd second = Eigen::MatrixXd::Zero(n, values.cols());

  if (ends == SplineEnds::kPeriodic) {
    // Unknowns at knots 0 .. n-2, cyclic; Sherman-Morrison folds the corners away.
    const Eigen::Index m = n - 1;
    Eigen::VectorXd lower(m), main(m), upper(m);
    Eigen::MatrixXd right(m, values.cols() + 1);
    for (Eigen::Index i = 0; i < m; ++i) {
      const Eigen::Index before = i == 0 ? m - 1 : i - 1;
      lower[i] = h[before];
      main[i] = 2.0 * (h[before] + h[i]);
      upper[i] = h[i];
      right.row(i).head(values.cols()) = 6.0 * (slope.row(i) - slope.row(before));
    }
    const double corner = lower[0];  // equals upper[m-1]
    if (m == 2) {                    // both neighbours are the same knot
      const double off = lower[0] + upper[0];
      const double det = main[0] * main[1] - off * off;
      const Eigen::MatrixXd r = right.leftCols(values.cols());
      second.row(0) = (main[1] * r.row(0) - off * r.row(1)) / det;
      second.row(1) = (main[0] * r.row(1) - off * r.row(0)) / det;
    } else {
      const double gamma = -main[0];
      main[0] -= gamma;
      main[m - 1] -= corner * corner / gamma;
      right.col(values.cols()).setZero();
      right(0, values.cols()) = gamma;
      right(m - 1, values.cols()) = corner;
      const Eigen::MatrixXd x = solve_tridiagonal(lower, main, upper, right);
      const Eigen::VectorXd z = x.col(values.cols());
      const double denominator = 1.0 + z[0] + corner / gamma * z[m - 1];
      for (Eigen::Index c = 0; c < values.cols(); ++c) {
        const double factor = (x(0, c) + corner / gamma * x(m - 1, c)) / denominator;
        second.col(c).head(m) = x.col(c) - factor * z;
      }
    }
    second.row(n - 1) = second.row(0);
    return second;
  }

  if (ends == SplineEnds::kNotAKnot && n < 4) {
    // Two points: a line. Three: one parabola.
    if (n == 3) second.rowwise() = Eigen::RowVectorXd(2.0 * (slope.row(1) - slope.row(0)) / (h[0] + h[1]));
    return second;
  }
  Eigen::VectorXd lower = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd main = Eigen::VectorXd::Ones(n);
  Eigen::VectorXd upper = Eigen::VectorXd::Zero(n);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, values.cols());
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    lower[i] = h[i - 1];
    main[i] = 2.0 * (h[i - 1] + h[i]);
    upper[i] = h[i];
    right.row(i) = 6.0 * (slope.row(i) - slope.row(i - 1));
  }
  if (ends == SplineEnds::kAtRest) {
    main[0] = 2.0 * h[0];
    upper[0] = h[0];
    right.row(0) = 6.0 * slope.row(0);
    main[n - 1] = 2.0 * h[n - 2];
    lower[n - 1] = h[n - 2];
    right.row(n - 1) = -6.0 * slope.row(n - 2);
    return solve_tridiagonal(lower, main, upper, right);
  }
  // Not a knot: the end's second derivative continues the line through its two neighbours; put into rows 1,
  // n-2.
  const double p = h[0] / h[1];
  main[1] += lower[1] * (1.0 + p);
  upper[1] -= lower[1] * p;
  const double q = h[n - 2] / h[n - 3];
  main[n - 2] += upper[n - 2] * (1.0 + q);
  lower[n - 2] -= upper[n - 2] * q;
  second.middleRows(1, n - 2) = solve_tridiagonal(lower.segment(1, n - 2), main.segment(1, n - 2),
                                                  upper.segment(1, n - 2), right.middleRows(1, n - 2));
  second.row(0) = (1.0 + p) * second.row(1) - p * second.row(2);
  second.row(n - 1) = (1.0 + q) * second.row(n - 2) - q * second.row(n - 3);
  return second;
}

}  // namespace telekerf::geometry
