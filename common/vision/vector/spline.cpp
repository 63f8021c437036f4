// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/spline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace telekerf::vision {
namespace {

constexpr std::size_t kMaxDegree = 10;
constexpr int kMaxHalvings = 20;

/// Control points of one span as a Bezier curve: x w, y w, w.
struct Bezier {
  std::array<Eigen::Vector3d, kMaxDegree + 1> d;
  std::size_t degree = 0;
  Vec2 point(std::size_t i) const { return d[i].head<2>() / d[i].z(); }
};

/// The span from knots[span] to the next: its control points are the spline's polar form of the span's ends.
Bezier bezier_of(const Spline& s, std::size_t span) {
  const auto p = static_cast<std::size_t>(s.degree);
  Bezier out;
  out.degree = p;
  for (std::size_t last = 0; last <= p; ++last) {
    std::array<Eigen::Vector3d, kMaxDegree + 1> d;
    for (std::size_t j = 0; j <= p; ++j) {
      const std::size_t i = span - p + j;
      const double w = s.weights.empty() ? 1.0 : s.weights[i];
      d[j] = {w * s.control[i].x(), w * s.control[i].y(), w};
    }
    for (std::size_t r = 1; r <= p; ++r) {  // de Boor's algorithm, its parameter the span's end `last` times
      const double t = s.knots[r <= last ? span + 1 : span];
      for (std::size_t j = p; j >= r; --j) {
        const double low = s.knots[span - p + j];
        const double high = s.knots[span + 1 + j - r];
        const double a = (t - low) / (high - low);
        d[j] = (1.0 - a) * d[j - 1] + a * d[j];
      }
    }
    out.d[last] = d[p];
  }
  return out;
}

/// The curve lies within the hull of its control points: it is as flat as these are.
bool is_flat(const Bezier& curve, double chord_error) {
  const Vec2 start = curve.point(0);
  const Vec2 chord = curve.point(curve.degree) - start;
  const double square = chord.squaredNorm();
  for (std::size_t i = 1; i < curve.degree; ++i) {
    const Vec2 way = curve.point(i) - start;
    const double t = square > 0.0 ? std::clamp(way.dot(chord) / square, 0.0, 1.0) : 0.0;
    if (!((way - t * chord).norm() <= chord_error)) return false;
  }
  return true;
}

/// Halves the curve (de Casteljau) until its parts are flat.
void draw(Bezier curve, int halvings, CurveWriter& w) {
  if (halvings == kMaxHalvings || is_flat(curve, w.chord_error()))
    return w.line_to(curve.point(curve.degree));
  Bezier first = curve;
  for (std::size_t r = 1; r <= curve.degree; ++r) {
    for (std::size_t j = 0; j + r <= curve.degree; ++j) curve.d[j] = 0.5 * (curve.d[j] + curve.d[j + 1]);
    first.d[r] = curve.d[0];
  }
  draw(first, halvings + 1, w);
  if (!w.full() && !w.bad()) draw(curve, halvings + 1, w);
}

}  // namespace

std::optional<std::string> complaint_of(const Spline& s) {
  const std::size_t n = s.control.size();
  const auto p = static_cast<std::size_t>(std::max(0, s.degree));
  if (p < 1 || p > kMaxDegree || n <= p || s.knots.size() != n + p + 1 ||
      !std::is_sorted(s.knots.begin(), s.knots.end()) || (!s.weights.empty() && s.weights.size() != n))
    return "a SPLINE's degree, knots and control points do not fit together";
  if (!std::all_of(s.weights.begin(), s.weights.end(), [](double weight) { return weight > 0.0; }))
    return "a SPLINE has a weight that is not positive";
  return std::nullopt;
}

void draw(const Spline& s, CurveWriter& w) {
  for (auto span = static_cast<std::size_t>(s.degree); span < s.control.size(); ++span) {
    if (!(s.knots[span + 1] > s.knots[span]) || w.full() || w.bad()) continue;
    const Bezier curve = bezier_of(s, span);
    if (w.points().empty()) w.move_to(curve.point(0));
    draw(curve, 0, w);
  }
}

}  // namespace telekerf::vision
