// SPDX-License-Identifier: Apache-2.0
// The true nearest point of a polyline: over the whole of it, or near where the tool was (thesis 3.3.1).
#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::geometry {

struct Nearest {
  double distance_m = 0.0;
  double signed_distance_m = 0.0;  ///< positive to the left of the drawing direction
  std::size_t segment = 0;
  double along = 0.0;         ///< 0..1 within the segment
  double arc_length_m = 0.0;  ///< travelled from the first point
  Vec2 point_m = Vec2::Zero();
  Vec2 tangent = Vec2::UnitX();  ///< unit, in drawing direction

  /// Index of the vertex that is nearer, for the window of points around it (eq. 15).
  std::size_t vertex(const Polyline& line) const noexcept {
    const std::size_t i = along > 0.5 ? segment + 1 : segment;
    return i < line.size() ? i : 0;
  }
};

/// How far a local search may look from the last segment, to either side.
struct LocalReach {
  double arc_m = 2e-3;  ///< shorter than the smallest loop that the path makes through a crossing
  std::size_t segments = 256;
};

/// A polyline with a static tree of capsules over its segments (a chord and how far the line strays from it):
/// on a smooth curve only those beside the foot point overlap, so a query is O(log n); boxes would overlap in
/// the hundreds. Queries are real-time code: noexcept, no allocation. Needs at least two points; zero-length
/// segments are tolerated.
class NearestIndex {
 public:
  /// An empty line, or a single point, becomes one zero-length segment, so that queries always have an
  /// answer.
  explicit NearestIndex(Polyline line);

  const Polyline& line() const noexcept { return line_; }
  double length_m() const noexcept { return arc_.back(); }

  /// Nearest point of the whole line, O(log n) on curves. NaN in, NaN distance out.
  Nearest find(const Vec2& query_m) const noexcept;
  /// Nearest point within `reach` of `last_segment`: at a crossing it stays on the branch it came along,
  /// because the other branch is far along the arc (eq. 15 with an argmin over everything would jump).
  Nearest find_near(const Vec2& query_m, std::size_t last_segment,
                    const LocalReach& reach = {}) const noexcept;
  /// The same along a distance travelled, which may wrap around a closed line.
  Nearest at(double arc_length_m) const noexcept;

 private:
  struct Node {
    Vec2 from = Vec2::Zero();
    Vec2 to = Vec2::Zero();
    double radius = 0.0;  ///< minus infinity: covers nothing
  };
  static constexpr std::size_t kLeaf = 4;  ///< segments in a leaf

  double bound(const Vec2& query, std::size_t node) const noexcept;
  double squared_distance(const Vec2& query, std::size_t segment, double& along) const noexcept;
  Nearest result(const Vec2& query, std::size_t segment, double along) const noexcept;
  Vec2 direction(std::size_t segment) const noexcept;

  Polyline line_;
  std::vector<double> arc_;
  std::vector<Node> nodes_;  ///< heap order: children of i are 2i+1 and 2i+2
  std::size_t leaves_ = 1;   ///< a power of two
};

}  // namespace telekerf::geometry
