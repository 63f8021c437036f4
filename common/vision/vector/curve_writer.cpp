// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/curve_writer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

std::vector<Vec2> CurveWriter::take() { return std::exchange(points_, {}); }

bool CurveWriter::add(const Vec2& p) {
  if (!p.allFinite()) bad_ = true;
  if (room_ == 0) full_ = true;
  if (bad_ || full_) return false;
  --room_;
  points_.push_back(p);
  return true;
}

void CurveWriter::move_to(const Vec2& p) {
  points_.clear();
  add(p);
}

void CurveWriter::line_to(const Vec2& p) { add(p); }

void CurveWriter::quadratic_to(const Vec2& control, const Vec2& end) {
  if (points_.empty()) return;
  const Vec2 start = points_.back();
  cubic_to(start + 2.0 / 3.0 * (control - start), end + 2.0 / 3.0 * (control - end), end);
}

void CurveWriter::cubic_to(const Vec2& a, const Vec2& b, const Vec2& end) {
  if (points_.empty()) return;
  const Vec2 start = points_.back();
  // The chord error of n equal steps is at most max|r''| / (8 n^2), and r'' is largest at an end.
  const double bend = 6.0 * std::max((start - 2.0 * a + b).norm(), (a - 2.0 * b + end).norm());
  if (!std::isfinite(bend)) {
    bad_ = true;
    return;
  }
  const double n = std::clamp(std::ceil(std::sqrt(bend / (8.0 * error_))), 1.0, 1e6);
  for (double i = 1.0; i < n; i += 1.0) {
    const double t = i / n;
    const double u = 1.0 - t;
    if (!add(u * u * u * start + 3.0 * u * u * t * a + 3.0 * u * t * t * b + t * t * t * end)) return;
  }
  add(end);
}

void CurveWriter::ellipse(const Vec2& centre, const Vec2& major, const Vec2& minor, double from, double to) {
  const double bend = std::max(major.norm(), minor.norm());
  const double sweep = to - from;
  if (!std::isfinite(bend) || !std::isfinite(sweep)) {
    bad_ = true;
    return;
  }
  // In quarters, so that a full circle touches its box exactly.
  const double n =
      4.0 * std::clamp(std::ceil(0.25 * std::abs(sweep) * std::sqrt(bend / (8.0 * error_))), 2.0, 2.5e5);
  for (double i = points_.empty() ? 0.0 : 1.0; i <= n; i += 1.0) {
    const double t = from + sweep * i / n;
    if (!add(centre + std::cos(t) * major + std::sin(t) * minor)) return;
  }
}

void CurveWriter::arc_to(Vec2 radii, double rotation_rad, bool large, bool sweep, const Vec2& end) {
  if (points_.empty()) return;
  const Vec2 start = points_.back();
  radii = radii.cwiseAbs();
  if (!(radii.minCoeff() > 0.0) || start == end) {
    if (start != end) add(end);
    return;
  }
  const double c = std::cos(rotation_rad);
  const double s = std::sin(rotation_rad);
  const Vec2 half = 0.5 * (start - end);
  const Vec2 p(c * half.x() + s * half.y(), -s * half.x() + c * half.y());
  const double stretch = p.cwiseQuotient(radii).squaredNorm();
  if (stretch > 1.0) radii *= std::sqrt(stretch);
  const double q = std::pow(radii.x() * p.y(), 2) + std::pow(radii.y() * p.x(), 2);
  const double over = std::max(0.0, std::pow(radii.x() * radii.y(), 2) - q);
  const double gain = (large == sweep ? -1.0 : 1.0) * (q > 0.0 ? std::sqrt(over / q) : 0.0);
  const Vec2 k(gain * radii.x() * p.y() / radii.y(), -gain * radii.y() * p.x() / radii.x());
  const Vec2 centre = 0.5 * (start + end) + Vec2(c * k.x() - s * k.y(), s * k.x() + c * k.y());
  const Vec2 u = (p - k).cwiseQuotient(radii);
  const Vec2 v = (-p - k).cwiseQuotient(radii);
  const double from = std::atan2(u.y(), u.x());
  double turn = std::atan2(geometry::cross(u, v), u.dot(v));
  if (sweep && turn < 0.0) turn += 2.0 * M_PI;
  if (!sweep && turn > 0.0) turn -= 2.0 * M_PI;
  ellipse(centre, radii.x() * Vec2(c, s), radii.y() * Vec2(-s, c), from, from + turn);
  if (!points_.empty() && !full_ && !bad_) points_.back() = end;
}

void CurveWriter::bulge_to(double bulge, const Vec2& end) {
  if (points_.empty()) return;
  const Vec2 start = points_.back();
  const Vec2 chord = end - start;
  if (!std::isfinite(bulge)) bad_ = true;
  if (std::abs(bulge) < 1e-12 || !(chord.norm() > 0.0)) {
    add(end);
    return;
  }
  // Distance of the centre from the chord's middle, to the left: chord (1 - b^2) / (4 b).
  const Vec2 left(-chord.y(), chord.x());
  const Vec2 centre = 0.5 * (start + end) + (1.0 - bulge * bulge) / (4.0 * bulge) * left;
  const Vec2 radius = start - centre;
  ellipse(centre, radius, Vec2(-radius.y(), radius.x()), 0.0, 4.0 * std::atan(bulge));
  if (!points_.empty() && !full_ && !bad_) points_.back() = end;
}

}  // namespace telekerf::vision
