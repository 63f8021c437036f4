// SPDX-License-Identifier: Apache-2.0
// Polylines: the ordered points that everything else in geometry is made from (thesis 3.1).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf::geometry {

/// z component of a x b: positive when b lies to the left of a.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Points in drawing order. A closed polyline does not repeat its first point: the last segment returns to
/// it. Units are the caller's; the names say metres because that is what crosses module borders.
struct Polyline {
  std::vector<Vec2> points_m;
  bool closed = false;

  std::size_t size() const noexcept { return points_m.size(); }
  std::size_t segments() const noexcept { return size() < 2 ? 0 : (closed ? size() : size() - 1); }
  const Vec2& start_of(std::size_t segment) const noexcept { return points_m[segment]; }
  const Vec2& end_of(std::size_t segment) const noexcept {
    return points_m[segment + 1 < size() ? segment + 1 : 0];
  }
};

struct Box {
  Vec2 min = Vec2::Zero();
  Vec2 max = Vec2::Zero();

  Vec2 centre() const noexcept { return 0.5 * (min + max); }
  Vec2 size() const noexcept { return max - min; }
};

struct Circle {
  Vec2 centre_m = Vec2::Zero();
  double radius_m = 0.0;
};

double length_m(const Polyline& line);
Box bounding_box(std::span<const Vec2> points);
/// Smallest circle around all points (Welzl, with a fixed seed: same points, same circle).
Circle bounding_circle(std::span<const Vec2> points);
/// Shoelace area; positive when the closed polygon runs anticlockwise (y up).
double signed_area_m2(const Polyline& line);
/// Distance travelled at each vertex: size() entries, and for a closed one the whole length at the end.
std::vector<double> arc_lengths(const Polyline& line);

/// True when every coordinate is finite.
bool all_finite(std::span<const Vec2> points);
/// Drops points closer than `tolerance_m` to their predecessor (and, closed, a last one equal to the first).
Polyline without_duplicates(const Polyline& line, double tolerance_m = 0.0);
Polyline reversed(const Polyline& line);
/// The closed polyline started at vertex `first`.
Polyline started_at(const Polyline& line, std::size_t first);

/// Points at equal distance along the line: the spacing is stretched to length / ceil(length / spacing) so
/// that no short remainder is left. Ends of an open line are kept exactly; corners between points are cut.
Polyline resampled(const Polyline& line, double spacing_m);
/// The same with the number of segments given.
Polyline resampled_to(const Polyline& line, std::size_t segments);

/// Fewest vertices that stay within `tolerance_m` of every given point (Ramer, Douglas, Peucker).
Polyline simplified(const Polyline& line, double tolerance_m);

}  // namespace telekerf::geometry
