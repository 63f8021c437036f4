// SPDX-License-Identifier: Apache-2.0
#include "common/vision/spline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace telekerf::vision {
namespace {

constexpr std::size_t kHighestDegree = 10;

/// de Boor's algorithm in homogeneous coordinates; `span` holds knots[span] <= t < knots[span + 1].
Vec2 point_at(const Spline& s, double t, std::size_t span) {
  std::array<Eigen::Vector3d, kHighestDegree + 1> d;
  const auto p = static_cast<std::size_t>(s.degree);
  for (std::size_t j = 0; j <= p; ++j) {
    const std::size_t i = span - p + j;
    const double w = s.weights.empty() ? 1.0 : s.weights[i];
    d[j] = {w * s.control[i].x(), w * s.control[i].y(), w};
  }
  for (std::size_t r = 1; r <= p; ++r) {
    for (std::size_t j = p; j >= r; --j) {
      const double low = s.knots[span - p + j];
      const double high = s.knots[span + 1 + j - r];
      const double a = high > low ? (t - low) / (high - low) : 0.0;
      d[j] = (1.0 - a) * d[j - 1] + a * d[j];
    }
  }
  return d[p].head<2>() / d[p].z();
}

/// Chords that a span is cut into: it bends no more than its control polygon.
double chords_of(const Spline& s, std::size_t span, double chord_error) {
  const auto p = static_cast<std::size_t>(s.degree);
  double bend = 0.0;
  for (std::size_t j = span - p; j + 2 <= span; ++j) {
    bend = std::max(bend, (s.control[j] - 2.0 * s.control[j + 1] + s.control[j + 2]).norm());
  }
  // |r''| over a span of parameter length 1 is at most about p^2 times the second difference; weights can
  // double that.
  const double gain = static_cast<double>(p * p) * (s.weights.empty() ? 1.0 : 4.0);
  return std::clamp(std::ceil(std::sqrt(gain * bend / (8.0 * chord_error))), 1.0, 1e6);
}

}  // namespace

std::optional<std::string> complaint_of(const Spline& s) {
  const std::size_t n = s.control.size();
  const auto p = static_cast<std::size_t>(std::max(0, s.degree));
  if (p < 1 || p > kHighestDegree || n <= p || s.knots.size() != n + p + 1 ||
      !std::is_sorted(s.knots.begin(), s.knots.end()) || (!s.weights.empty() && s.weights.size() != n))
    return "a SPLINE's degree, knots and control points do not fit together";
  if (!std::all_of(s.weights.begin(), s.weights.end(), [](double weight) { return weight > 0.0; }))
    return "a SPLINE has a weight that is not positive";
  return std::nullopt;
}

void draw(const Spline& s, CurveWriter& w) {
  for (auto span = static_cast<std::size_t>(s.degree); span < s.control.size(); ++span) {
    const double from = s.knots[span];
    const double to = s.knots[span + 1];
    if (!(to > from)) continue;
    if (w.points().empty()) w.move_to(point_at(s, from, span));
    const double chords = chords_of(s, span, w.chord_error());
    for (double i = 1.0; i <= chords && !w.full() && !w.bad(); i += 1.0) {
      w.line_to(point_at(s, from + (to - from) * i / chords, span));
    }
  }
}

}  // namespace telekerf::vision
