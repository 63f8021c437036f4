// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/fit_points.h"

#include <cmath>
#include <cstddef>

namespace telekerf::vision {
namespace {

/// Solves a tridiagonal system for vectors (Thomas); the matrix is dominated by its diagonal.
std::vector<Vec2> solved(std::vector<double> low, std::vector<double> middle, std::vector<double> high,
                         std::vector<Vec2> right) {
  const std::size_t n = middle.size();
  for (std::size_t i = 1; i < n; ++i) {
    const double f = low[i] / middle[i - 1];
    middle[i] -= f * high[i - 1];
    right[i] -= f * right[i - 1];
  }
  for (std::size_t i = n; i-- > 0;) {
    if (i + 1 < n) right[i] -= high[i] * right[i + 1];
    right[i] /= middle[i];
  }
  return right;
}

/// dr/dt at every point: what makes the second derivative continuous.
std::vector<Vec2> derivatives(const std::vector<Vec2>& p, const std::vector<double>& h,
                              const FitPoints& fit) {
  const std::size_t n = p.size();
  std::vector<double> low(n, 0.0);
  std::vector<double> middle(n, 1.0);
  std::vector<double> high(n, 0.0);
  std::vector<Vec2> right(n, Vec2::Zero());
  for (std::size_t i = 1; i + 1 < n; ++i) {
    low[i] = h[i];
    middle[i] = 2.0 * (h[i - 1] + h[i]);
    high[i] = h[i - 1];
    right[i] = 3.0 * (h[i] / h[i - 1] * (p[i] - p[i - 1]) + h[i - 1] / h[i] * (p[i + 1] - p[i]));
  }
  if (!fit.start_tangent.isZero()) {
    right[0] = fit.start_tangent.normalized();
  } else {
    middle[0] = 2.0;
    high[0] = 1.0;
    right[0] = 3.0 / h[0] * (p[1] - p[0]);
  }
  if (!fit.end_tangent.isZero()) {
    right[n - 1] = fit.end_tangent.normalized();
  } else {
    low[n - 1] = 1.0;
    middle[n - 1] = 2.0;
    right[n - 1] = 3.0 / h[n - 2] * (p[n - 1] - p[n - 2]);
  }
  return solved(low, middle, high, right);
}

}  // namespace

void draw(const FitPoints& fit, CurveWriter& w) {
  std::vector<Vec2> p;
  for (const Vec2& q : fit.points) {
    if (p.empty() || (q - p.back()).norm() > 0.0) p.push_back(q);
  }
  // A closed one runs round three times, so that the ends of the system do not matter: they die away as
  // 0.27^n.
  const bool closed = fit.closed && p.size() > 2;
  if (closed && (p.front() - p.back()).norm() < 1e-9 * (p[1] - p[0]).norm()) p.pop_back();
  const std::size_t n = p.size();
  std::size_t first = 0;
  std::size_t last = n == 0 ? 0 : n - 1;
  if (closed) {
    const std::size_t around = n < 20 ? 20 / n + 1 : 1;
    const std::vector<Vec2> once = p;
    p.clear();
    for (std::size_t turn = 0; turn < 2 * around + 1; ++turn) p.insert(p.end(), once.begin(), once.end());
    p.push_back(once.front());
    first = around * n;
    last = first + n;
  }
  if (p.size() < 2) return;
  std::vector<double> h;
  for (std::size_t i = 0; i + 1 < p.size(); ++i) h.push_back((p[i + 1] - p[i]).norm());
  FitPoints ends = fit;
  if (closed) ends.start_tangent = ends.end_tangent = Vec2::Zero();
  const std::vector<Vec2> d = derivatives(p, h, ends);
  for (std::size_t i = first; i < last && !w.full() && !w.bad(); ++i) {
    if (i == first) w.move_to(p[i]);
    w.cubic_to(p[i] + h[i] / 3.0 * d[i], p[i + 1] - h[i] / 3.0 * d[i + 1], p[i + 1]);
  }
}

}  // namespace telekerf::vision
