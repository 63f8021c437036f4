// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/cutting_order.h"

#include <limits>

namespace telekerf::geometry {

bool encloses(const Polyline& outer, const Polyline& inner) {
  if (!outer.closed || outer.size() < 3 || inner.points_m.empty()) return false;
  const Vec2& q = inner.points_m.front();
  bool inside = false;
  for (std::size_t i = 0; i < outer.segments(); ++i) {
    const Vec2& a = outer.start_of(i);
    const Vec2& b = outer.end_of(i);
    if ((a.y() > q.y()) == (b.y() > q.y())) continue;
    if (q.x() < a.x() + (q.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

CuttingOrder cutting_order(const std::vector<Polyline>& contours, const Vec2& start_m) {
  const std::size_t n = contours.size();
  std::vector<std::vector<std::size_t>> around(n);  // the contours that enclose i
  std::vector<std::size_t> waiting_for(n, 0);       // how many inside i are still to be cut
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      if (i == j || !encloses(contours[j], contours[i])) continue;
      around[i].push_back(j);
      ++waiting_for[j];
    }
  }
  CuttingOrder out;
  std::vector<bool> done(n, false);
  Vec2 at = start_m;
  while (out.order.size() < n) {
    std::size_t next = n;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
      if (done[i] || waiting_for[i] > 0) continue;
      const double distance = contours[i].points_m.empty() ? 0.0 : (contours[i].points_m.front() - at).norm();
      if (next == n || distance < nearest) {
        nearest = distance;
        next = i;
      }
    }
    if (next == n) {  // borders that enclose each other do not exist, but never loop for ever
      for (std::size_t i = 0; i < n; ++i) {
        if (!done[i]) next = i;
      }
    }
    done[next] = true;
    for (const std::size_t j : around[next]) --waiting_for[j];
    out.order.push_back(next);
    if (contours[next].points_m.empty()) continue;
    out.travel_m += (contours[next].points_m.front() - at).norm();
    at = contours[next].closed ? contours[next].points_m.front() : contours[next].points_m.back();
  }
  return out;
}

}  // namespace telekerf::geometry
