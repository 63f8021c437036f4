// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/cutting_order.h"

#include <algorithm>
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

namespace {

/// The contours around each: only those whose boxes hold its first point are looked at, found from left to
/// right.
std::vector<std::vector<std::size_t>> contours_around(const std::vector<Polyline>& contours) {
  const std::size_t n = contours.size();
  std::vector<std::vector<std::size_t>> out(n);
  std::vector<Box> boxes;
  std::vector<std::size_t> by_left;
  std::vector<std::size_t> by_point;
  for (std::size_t i = 0; i < n; ++i) {
    boxes.push_back(bounding_box(contours[i].points_m));
    if (contours[i].points_m.empty()) continue;
    by_point.push_back(i);
    if (contours[i].closed) by_left.push_back(i);
  }
  std::sort(by_left.begin(), by_left.end(),
            [&](std::size_t a, std::size_t b) { return boxes[a].min.x() < boxes[b].min.x(); });
  std::sort(by_point.begin(), by_point.end(), [&](std::size_t a, std::size_t b) {
    return contours[a].points_m.front().x() < contours[b].points_m.front().x();
  });
  std::vector<std::size_t> reaching;  // boxes that the point may lie in
  std::size_t next = 0;
  for (const std::size_t i : by_point) {
    const Vec2& q = contours[i].points_m.front();
    while (next < by_left.size() && boxes[by_left[next]].min.x() <= q.x())
      reaching.push_back(by_left[next++]);
    std::erase_if(reaching, [&](std::size_t j) { return boxes[j].max.x() < q.x(); });
    for (const std::size_t j : reaching) {
      if (j == i || boxes[j].min.y() > q.y() || boxes[j].max.y() < q.y()) continue;
      if (encloses(contours[j], contours[i])) out[i].push_back(j);
    }
    std::sort(out[i].begin(), out[i].end());
  }
  return out;
}

}  // namespace

std::vector<bool> holes(const std::vector<Polyline>& contours) {
  std::vector<bool> out;
  for (const auto& around : contours_around(contours)) out.push_back(around.size() % 2 == 1);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = out[i] && contours[i].closed;
  return out;
}

CuttingOrder cutting_order(const std::vector<Polyline>& contours, const Vec2& start_m) {
  const std::size_t n = contours.size();
  const std::vector<std::vector<std::size_t>> around = contours_around(contours);
  std::vector<std::size_t> waiting_for(n, 0);  // how many inside i are still to be cut
  for (const auto& outer : around) {
    for (const std::size_t j : outer) ++waiting_for[j];
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
