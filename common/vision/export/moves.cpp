// SPDX-License-Identifier: Apache-2.0
#include "common/vision/export/moves.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "common/geometry/polyline.h"

namespace telekerf::vision {
namespace {

constexpr std::size_t kFewestPointsOfAnArc = 4;  // three points lie on a circle always

/// The straight move from the first of the points to the last, if all are within the tolerance of it.
std::optional<Move> straight(std::span<const Vec2> points, double tolerance_m) {
  const Vec2 way = points.back() - points.front();
  for (const Vec2& p : points.subspan(1, points.size() - 2)) {
    const double along = std::clamp((p - points.front()).dot(way) / way.squaredNorm(), 0.0, 1.0);
    // Not "greater than": where first and last are one point nothing is along the way.
    if (!((p - points.front() - along * way).norm() <= tolerance_m)) return {};
  }
  return Move{points.back()};
}

/// The circular one: its centre, on the chord's bisector, is the least squares' of all points.
std::optional<Move> circular(std::span<const Vec2> points, double tolerance_m) {
  if (points.size() < kFewestPointsOfAnArc) return {};
  const Vec2 chord = points.back() - points.front();
  const Vec2 middle = 0.5 * (points.front() + points.back());
  const Vec2 normal = Vec2(-chord.y(), chord.x()).normalized();
  const double half_squared = 0.25 * chord.squaredNorm();
  double product = 0.0;
  double square = 0.0;
  for (const Vec2& p : points) {
    const double height = normal.dot(p - middle);
    product += height * ((p - middle).squaredNorm() - half_squared);
    square += 2.0 * height * height;
  }
  const Vec2 centre = middle + product / square * normal;
  const double radius = (points.front() - centre).norm();
  const auto on_it = [&](const Vec2& p) {
    return std::abs((p - centre).norm() - radius) <= tolerance_m;  // false for what is not finite
  };
  double turn = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec2 from = points[i - 1] - centre;
    const Vec2 to = points[i] - centre;
    const double step = std::atan2(geometry::cross(from, to), from.dot(to));
    if (!on_it(points[i]) || !on_it(0.5 * (points[i - 1] + points[i])) || step * turn < 0.0) return {};
    turn += step;
  }
  if (std::abs(turn) > M_PI) return {};
  return Move{points.back(), true, centre, turn < 0.0};
}

/// The farthest that `fits` reaches from the first point on, and how many points it passes: found by
/// doubling, then by halving the doubt.
template <typename Fits>
std::pair<std::size_t, std::optional<Move>> farthest(std::span<const Vec2> points, std::size_t fewest,
                                                     Fits fits) {
  std::size_t good = 0;
  std::optional<Move> move;
  const auto reaches = [&](std::size_t count) {
    const std::optional<Move> tried = fits(points.first(count));
    if (!tried) return false;
    good = count;
    move = tried;
    return true;
  };
  std::size_t bad = points.size() + 1;
  for (std::size_t count = std::min(fewest, points.size()); good < points.size();) {
    if (!reaches(count)) {
      bad = count;
      break;
    }
    count = std::min(2 * count, points.size());
  }
  while (good > 0 && bad - good > 1) {
    const std::size_t count = good + (bad - good) / 2;
    if (!reaches(count)) bad = count;
  }
  return {good, move};
}

}  // namespace

std::vector<Move> moves_along(std::span<const Vec2> points_m, double tolerance_m, bool arcs) {
  std::vector<Move> out;
  while (points_m.size() > 1) {
    auto best = farthest(points_m, 2, [&](auto points) { return straight(points, tolerance_m); });
    if (arcs) {
      const auto arc = farthest(points_m, kFewestPointsOfAnArc,
                                [&](auto points) { return circular(points, tolerance_m); });
      if (arc.first > best.first) best = arc;
    }
    out.push_back(*best.second);
    points_m = points_m.subspan(best.first - 1);
  }
  return out;
}

}  // namespace telekerf::vision
