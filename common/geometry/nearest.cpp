// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/nearest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace telekerf::geometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double distance_to_segment(const Vec2& q, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double d2 = d.squaredNorm();
  const double u = d2 > 0.0 ? std::clamp((q - a).dot(d) / d2, 0.0, 1.0) : 0.0;
  return (q - a - u * d).norm();
}

}  // namespace

NearestIndex::NearestIndex(Polyline line) : line_(std::move(line)) {
  if (line_.points_m.empty()) line_.points_m.push_back(Vec2::Zero());
  if (line_.size() == 1) line_.points_m.push_back(line_.points_m[0]);
  arc_ = arc_lengths(line_);

  const std::size_t n = line_.segments();
  while (leaves_ * kLeaf < n) leaves_ *= 2;
  nodes_.assign(2 * leaves_ - 1, {Vec2::Zero(), Vec2::Zero(), -kInfinity});
  for (std::size_t first = 0; first < n; first += kLeaf) {
    Node& node = nodes_[leaves_ - 1 + first / kLeaf];
    const std::size_t last = std::min(first + kLeaf, n) - 1;
    node = {line_.start_of(first), line_.end_of(last), 0.0};
    for (std::size_t i = first; i < last; ++i) {
      node.radius = std::max(node.radius, distance_to_segment(line_.end_of(i), node.from, node.to));
    }
  }
  for (std::size_t i = leaves_ - 1; i-- > 0;) {
    const Node& left = nodes_[2 * i + 1];
    const Node& right = nodes_[2 * i + 2];
    Node& node = nodes_[i];
    if (left.radius < 0.0) continue;
    node = {left.from, right.radius < 0.0 ? left.to : right.to, 0.0};
    for (const Node* child : {&left, &right}) {
      if (child->radius < 0.0) continue;
      // A chord strays furthest at one of its ends.
      node.radius =
          std::max(node.radius, child->radius + std::max(distance_to_segment(child->from, node.from, node.to),
                                                         distance_to_segment(child->to, node.from, node.to)));
    }
  }
}

double NearestIndex::bound(const Vec2& query, std::size_t node) const noexcept {
  const Node& n = nodes_[node];
  // A hair less than the true bound, so that rounding never hides the nearest segment.
  return std::max(0.0, distance_to_segment(query, n.from, n.to) * (1.0 - 1e-12) - n.radius * (1.0 + 1e-12));
}

double NearestIndex::squared_distance(const Vec2& query, std::size_t segment, double& along) const noexcept {
  const Vec2& a = line_.start_of(segment);
  const Vec2 d = line_.end_of(segment) - a;
  const double d2 = d.squaredNorm();
  along = d2 > 0.0 ? std::clamp((query - a).dot(d) / d2, 0.0, 1.0) : 0.0;
  return (query - a - along * d).squaredNorm();
}

Vec2 NearestIndex::direction(std::size_t segment) const noexcept {
  const Vec2 d = line_.end_of(segment) - line_.start_of(segment);
  const double norm = d.norm();
  return norm > 0.0 ? Vec2(d / norm) : Vec2::UnitX();
}

Nearest NearestIndex::result(const Vec2& query, std::size_t segment, double along) const noexcept {
  const std::size_t n = line_.segments();
  const Vec2& a = line_.start_of(segment);
  Nearest out;
  out.segment = segment;
  out.along = along;
  out.point_m = a + along * (line_.end_of(segment) - a);
  out.distance_m = (query - out.point_m).norm();
  out.arc_length_m = arc_[segment] + along * (arc_[segment + 1] - arc_[segment]);
  out.tangent = direction(segment);
  // At a vertex one segment alone may name the wrong side; the sum of both directions does not.
  Vec2 forward = out.tangent;
  if (along >= 1.0 && (line_.closed || segment + 1 < n)) forward += direction((segment + 1) % n);
  if (along <= 0.0 && (line_.closed || segment > 0)) forward += direction((segment + n - 1) % n);
  out.signed_distance_m = std::copysign(out.distance_m, cross(forward, query - out.point_m));
  return out;
}

Nearest NearestIndex::find(const Vec2& query_m) const noexcept {
  // Depth first, the nearer child first; the stack never holds more than one sibling a level.
  std::array<std::pair<std::size_t, double>, 130> stack;
  std::size_t top = 0;
  stack[top++] = {0, bound(query_m, 0)};
  double best = kInfinity;
  std::size_t best_segment = 0;
  double best_along = 0.0;
  while (top > 0) {
    const auto [node, least] = stack[--top];
    if (least * least > best) continue;
    if (node >= leaves_ - 1) {
      const std::size_t first = (node - (leaves_ - 1)) * kLeaf;
      const std::size_t last = std::min(first + kLeaf, line_.segments());
      for (std::size_t i = first; i < last; ++i) {
        double along = 0.0;
        const double d2 = squared_distance(query_m, i, along);
        if (d2 < best) {
          best = d2;
          best_segment = i;
          best_along = along;
        }
      }
      continue;
    }
    const std::size_t left = 2 * node + 1;
    const double d_left = bound(query_m, left);
    const double d_right = bound(query_m, left + 1);
    const bool left_first = d_left <= d_right;
    stack[top++] = left_first ? std::pair{left + 1, d_right} : std::pair{left, d_left};
    stack[top++] = left_first ? std::pair{left, d_left} : std::pair{left + 1, d_right};
  }
  return result(query_m, best_segment, best_along);
}

Nearest NearestIndex::find_near(const Vec2& query_m, std::size_t last_segment,
                                const LocalReach& reach) const noexcept {
  const std::size_t n = line_.segments();
  const std::size_t start = std::min(last_segment, n - 1);
  double best_along = 0.0;
  double best = squared_distance(query_m, start, best_along);
  std::size_t best_segment = start;
  // Half of a closed line to either side is all of it; more would visit segments twice.
  const std::size_t most = std::min(reach.segments, line_.closed ? n / 2 : n);
  for (const bool forwards : {true, false}) {
    std::size_t i = start;
    double walked = 0.0;
    for (std::size_t step = 0; step < most && walked <= reach.arc_m; ++step) {
      if (forwards ? i + 1 == n : i == 0) {
        if (!line_.closed) break;
        i = forwards ? 0 : n - 1;
      } else {
        i = forwards ? i + 1 : i - 1;
      }
      double along = 0.0;
      const double d2 = squared_distance(query_m, i, along);
      if (d2 < best) {
        best = d2;
        best_segment = i;
        best_along = along;
      }
      walked += arc_[i + 1] - arc_[i];
    }
  }
  return result(query_m, best_segment, best_along);
}

Nearest NearestIndex::at(double arc_length_m) const noexcept {
  const double length = arc_.back();
  double s = arc_length_m;
  if (line_.closed && length > 0.0) {
    s = std::fmod(s, length);
    if (s < 0.0) s += length;
  }
  s = std::clamp(s, 0.0, length);
  const auto above = std::upper_bound(arc_.begin() + 1, arc_.end() - 1, s);
  const auto segment = static_cast<std::size_t>(above - arc_.begin()) - 1;
  const double span = arc_[segment + 1] - arc_[segment];
  const double along = span > 0.0 ? (s - arc_[segment]) / span : 0.0;
  const Vec2 point = line_.start_of(segment) + along * (line_.end_of(segment) - line_.start_of(segment));
  return result(point, segment, along);
}

}  // namespace telekerf::geometry
