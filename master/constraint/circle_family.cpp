// SPDX-License-Identifier: Apache-2.0
#include "master/constraint/circle_family.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "master/constraint/guide_curve.h"

namespace telekerf::master {
namespace {

using geometry::CircleOrLine;

/// The line through the weighted mean along the largest spread, in drawing order.
CircleOrLine fit_line(std::span<const Vec2> points, std::span<const double> weights) noexcept {
  Vec2 mean = Vec2::Zero();
  double sum = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    mean += weights[i] * points[i];
    sum += weights[i];
  }
  mean /= sum;
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 d = points[i] - mean;
    xx += weights[i] * d.x() * d.x();
    xy += weights[i] * d.x() * d.y();
    yy += weights[i] * d.y() * d.y();
  }
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  CircleOrLine out;
  out.point_m = mean;
  out.direction = Vec2(std::cos(angle), std::sin(angle));
  if (out.direction.dot(points.back() - points.front()) < 0.0) out.direction = -out.direction;
  return out;
}

}  // namespace

CircleFamily::CircleFamily(const geometry::Polyline& line, double spacing_m,
                           const ConstraintSettings& settings)
    : lines_(settings.curve == CurveKind::kLines),
      taper_(settings.taper),
      min_radius_m_(settings.min_radius_m),
      spacing_m_(spacing_m) {
  const auto n = static_cast<long>(line.size());
  const auto tangent = [&](long i) -> Vec2 {
    return (line.points_m[index_of(line, i + 1)] - line.points_m[index_of(line, i - 1)]).normalized();
  };
  const auto most = static_cast<double>(std::min<long>(settings.half_window, geometry::kMaxHalfWindow));
  half_window_.assign(static_cast<std::size_t>(n), most);
  if (settings.window_bend_rad >= std::numbers::pi) return;
  for (long i = 0; i < n; ++i) {
    const Vec2 here = tangent(i);
    double& half = half_window_[static_cast<std::size_t>(i)];
    for (long k = 1; static_cast<double>(k) < most; ++k) {
      const double cosine = std::min(here.dot(tangent(i + k)), here.dot(tangent(i - k)));
      if (cosine >= std::cos(settings.window_bend_rad)) continue;
      half = std::max(2.0, static_cast<double>(k));
      break;
    }
  }
  // So that the windows open and close gradually: points by which neighbours differ at most.
  constexpr double kOpening = 0.5;
  const long steps = line.closed ? 2 * n : n - 1;
  const auto soften = [&](long from, long to) {
    double& half = half_window_[index_of(line, to)];
    half = std::min(half, half_window_[index_of(line, from)] + kOpening);
  };
  for (long i = 0; i < steps; ++i) soften(i, i + 1);
  for (long i = steps; i > 0; --i) soften(i, i - 1);
}

GuidePiece CircleFamily::at(const geometry::Polyline& line, double arc_m) const noexcept {
  const double place = arc_m / spacing_m_;
  const long middle = std::lround(place);
  const long before = std::clamp<long>(static_cast<long>(place), 0, static_cast<long>(line.segments()) - 1);
  const double share = place - static_cast<double>(before);
  const double here = half_window_[index_of(line, before)];
  const double width = here + share * (half_window_[index_of(line, before + 1)] - here);
  const long half = std::min<long>(std::lround(std::ceil(width)), geometry::kMaxHalfWindow);

  std::array<Vec2, 2 * geometry::kMaxHalfWindow + 1> points;
  std::array<double, 2 * geometry::kMaxHalfWindow + 1> weights;
  std::size_t count = 0;
  for (long i = middle - half; i <= middle + half; ++i) {
    if (!line.closed && (i < 0 || i >= static_cast<long>(line.size()))) continue;
    points[count] = line.points_m[index_of(line, i)];
    // Hann: the nearest point changes half way between two, where the outermost ones weigh nothing.
    const double away = (static_cast<double>(i) - place) / (width + 0.5);
    weights[count] = taper_ ? 0.5 + 0.5 * std::cos(std::numbers::pi * std::clamp(away, -1.0, 1.0)) : 1.0;
    ++count;
  }
  const std::span<const Vec2> used(points.data(), count);
  const std::span<const double> weighted(weights.data(), count);

  GuidePiece piece;
  piece.arc_m = arc_m;
  piece.shape = lines_ ? fit_line(used, weighted) : geometry::fit_circle(used, weighted);
  const Vec2& a = line.start_of(static_cast<std::size_t>(before));
  const Vec2& b = line.end_of(static_cast<std::size_t>(before));
  piece.point_m = piece.shape.project(a + share * (b - a));
  // Through a hairpin a circle may be as tight as it likes; no tool turns round within one.
  const double bend = piece.shape.curvature();
  if (min_radius_m_ > 0.0 && std::abs(bend) * min_radius_m_ > 1.0) {
    piece.shape = geometry::osculating(piece.point_m, piece.shape.tangent(piece.point_m),
                                       std::copysign(1.0 / min_radius_m_, bend));
  }
  return piece;
}

}  // namespace telekerf::master
