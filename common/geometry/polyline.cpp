// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/polyline.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace telekerf::geometry {

double length_m(const Polyline& line) {
  double length = 0.0;
  for (std::size_t i = 0; i < line.segments(); ++i) length += (line.end_of(i) - line.start_of(i)).norm();
  return length;
}

Box bounding_box(std::span<const Vec2> points) {
  if (points.empty()) return {};
  Box box{points[0], points[0]};
  for (const Vec2& p : points) {
    box.min = box.min.cwiseMin(p);
    box.max = box.max.cwiseMax(p);
  }
  return box;
}

namespace {

bool contains(const Circle& circle, const Vec2& p) {
  return (p - circle.centre_m).norm() <= circle.radius_m * (1.0 + 1e-12);
}

Circle circle_of(const Vec2& a, const Vec2& b) { return {0.5 * (a + b), 0.5 * (b - a).norm()}; }

/// Smallest circle around three points: their circumcircle, or the widest pair when they stand in line.
Circle circle_of(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 u = b - a;
  const Vec2 v = c - a;
  const double d = 2.0 * cross(u, v);
  if (std::abs(d) <= 1e-14 * (u.squaredNorm() + v.squaredNorm())) {
    Circle widest = circle_of(a, b);
    for (const Circle& other : {circle_of(a, c), circle_of(b, c)}) {
      if (other.radius_m > widest.radius_m) widest = other;
    }
    return widest;
  }
  const Vec2 w((v.y() * u.squaredNorm() - u.y() * v.squaredNorm()) / d,
               (u.x() * v.squaredNorm() - v.x() * u.squaredNorm()) / d);
  return {a + w, w.norm()};
}

}  // namespace

Circle bounding_circle(std::span<const Vec2> points) {
  if (points.empty()) return {};
  std::vector<Vec2> p(points.begin(), points.end());
  std::shuffle(p.begin(), p.end(), std::mt19937_64(1));
  Circle circle{p[0], 0.0};
  for (std::size_t i = 1; i < p.size(); ++i) {
    if (contains(circle, p[i])) continue;
    circle = {p[i], 0.0};
    for (std::size_t j = 0; j < i; ++j) {
      if (contains(circle, p[j])) continue;
      circle = circle_of(p[i], p[j]);
      for (std::size_t k = 0; k < j; ++k) {
        if (!contains(circle, p[k])) circle = circle_of(p[i], p[j], p[k]);
      }
    }
  }
  return circle;
}

double signed_area_m2(const Polyline& line) {
  if (line.size() < 3) return 0.0;
  const Vec2 origin = line.points_m[0];  // keeps the products small far from zero
  double twice = 0.0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    twice += cross(line.points_m[i] - origin, line.points_m[(i + 1) % line.size()] - origin);
  }
  return 0.5 * twice;
}

std::vector<double> arc_lengths(const Polyline& line) {
  std::vector<double> s(line.size() < 2 ? line.size() : line.segments() + 1, 0.0);
  for (std::size_t i = 0; i < line.segments(); ++i)
    s[i + 1] = s[i] + (line.end_of(i) - line.start_of(i)).norm();
  return s;
}

bool all_finite(std::span<const Vec2> points) {
  return std::all_of(points.begin(), points.end(), [](const Vec2& p) { return p.allFinite(); });
}

Polyline without_duplicates(const Polyline& line, double tolerance_m) {
  Polyline out{{}, line.closed};
  out.points_m.reserve(line.size());
  for (const Vec2& p : line.points_m) {
    if (out.points_m.empty() || (p - out.points_m.back()).norm() > tolerance_m) out.points_m.push_back(p);
  }
  while (out.closed && out.size() > 1 && (out.points_m.back() - out.points_m.front()).norm() <= tolerance_m) {
    out.points_m.pop_back();
  }
  return out;
}

Polyline reversed(const Polyline& line) {
  Polyline out = line;
  std::reverse(out.points_m.begin(), out.points_m.end());
  return out;
}

Polyline started_at(const Polyline& line, std::size_t first) {
  Polyline out = line;
  if (first < out.size()) std::rotate(out.points_m.begin(), out.points_m.begin() + first, out.points_m.end());
  return out;
}

Polyline resampled(const Polyline& line, double spacing_m) {
  const double length = length_m(line);
  if (!(spacing_m > 0.0) || !(length > 0.0)) return line;
  // A hair of slack, so that a length which is a multiple of the spacing keeps that spacing.
  return resampled_to(line, static_cast<std::size_t>(std::ceil(length / spacing_m * (1.0 - 1e-12))));
}

Polyline resampled_to(const Polyline& line, std::size_t segments) {
  if (line.segments() == 0 || segments == 0) return line;
  const std::vector<double> s = arc_lengths(line);
  const double length = s.back();
  Polyline out{{}, line.closed};
  const std::size_t count = line.closed ? segments : segments + 1;
  out.points_m.reserve(count);
  std::size_t at = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!line.closed && i == segments) {
      out.points_m.push_back(line.points_m.back());
      break;
    }
    const double target = length * static_cast<double>(i) / static_cast<double>(segments);
    while (at + 1 < line.segments() && s[at + 1] <= target) ++at;
    const double span = s[at + 1] - s[at];
    const double u = span > 0.0 ? std::clamp((target - s[at]) / span, 0.0, 1.0) : 0.0;
    out.points_m.push_back(line.start_of(at) + u * (line.end_of(at) - line.start_of(at)));
  }
  return out;
}

Polyline simplified(const Polyline& line, double tolerance_m) {
  const std::size_t n = line.size();
  if (n < 3) return line;
  std::vector<Vec2> p = line.points_m;
  if (line.closed) p.push_back(p.front());
  std::vector<bool> keep(p.size(), false);
  keep.front() = keep.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, p.size() - 1}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    const Vec2 d = p[b] - p[a];
    const double d2 = d.squaredNorm();
    double worst = tolerance_m;
    std::size_t at = 0;
    for (std::size_t i = a + 1; i < b; ++i) {
      const double u = d2 > 0.0 ? std::clamp((p[i] - p[a]).dot(d) / d2, 0.0, 1.0) : 0.0;
      const double distance = (p[i] - p[a] - u * d).norm();
      if (distance > worst) {
        worst = distance;
        at = i;
      }
    }
    if (at == 0) continue;
    keep[at] = true;
    open.emplace_back(a, at);
    open.emplace_back(at, b);
  }
  Polyline out{{}, line.closed};
  for (std::size_t i = 0; i < n; ++i) {
    if (keep[i]) out.points_m.push_back(p[i]);
  }
  return out;
}

}  // namespace telekerf::geometry
