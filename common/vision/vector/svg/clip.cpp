// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/svg/clip.h"

#include <algorithm>
#include <cmath>

namespace telekerf::vision {
namespace {

constexpr double kOn_m = 1e-6;

/// -1 outside, 0 on the border, 1 inside.
int side_of(const geometry::Polyline& ring, const Vec2& p) {
  bool inside = false;
  for (std::size_t i = 0; i < ring.segments(); ++i) {
    const Vec2& a = ring.start_of(i);
    const Vec2& b = ring.end_of(i);
    const Vec2 way = b - a;
    const double square = way.squaredNorm();
    const double t = square > 0.0 ? std::clamp((p - a).dot(way) / square, 0.0, 1.0) : 0.0;
    if ((a + t * way - p).norm() <= kOn_m) return 0;
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside ? 1 : -1;
}

bool cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const auto side = [](const Vec2& from, const Vec2& to, const Vec2& p) {
    const double distance = geometry::cross(to - from, p - from) / std::max((to - from).norm(), 1e-300);
    return distance > kOn_m ? 1 : distance < -kOn_m ? -1 : 0;
  };
  return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

}  // namespace

Clipped clipped(const geometry::Polyline& line, const std::vector<geometry::Polyline>& hole) {
  bool in = false;
  bool out = false;
  for (const Vec2& p : line.points_m) {
    int best = -1;
    for (const auto& ring : hole) best = std::max(best, side_of(ring, p));
    in = in || best == 1;
    out = out || best == -1;
  }
  if (in && out) return Clipped::kCut;
  for (std::size_t i = 0; i < line.segments(); ++i) {
    for (const auto& ring : hole) {
      for (std::size_t k = 0; k < ring.segments(); ++k) {
        if (cross(line.start_of(i), line.end_of(i), ring.start_of(k), ring.end_of(k))) return Clipped::kCut;
      }
    }
  }
  if (!out) return Clipped::kInside;
  const bool around = line.closed && std::any_of(hole.begin(), hole.end(), [&](const auto& ring) {
                        return std::any_of(ring.points_m.begin(), ring.points_m.end(),
                                           [&](const Vec2& p) { return side_of(line, p) == 1; });
                      });
  return around ? Clipped::kCut : Clipped::kOutside;
}

}  // namespace telekerf::vision
