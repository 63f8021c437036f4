// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/joining.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

#include "common/vision/vector/end_points.h"

namespace telekerf::vision {
namespace {

using geometry::Polyline;
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// The open lines as a graph: an edge a line, its ends at nodes. Half-edge 2 e leaves the line's first point,
/// 2 e + 1 its last.
class LineGraph {
 public:
  LineGraph(std::vector<Polyline>& lines, std::vector<std::size_t> edges, double tolerance)
      : lines_(lines), edges_(std::move(edges)), tolerance_(tolerance) {
    std::vector<Vec2> ends;
    for (const std::size_t line : edges_) {
      ends.push_back(lines_[line].points_m.front());
      ends.push_back(lines_[line].points_m.back());
      length_.push_back(geometry::length_m(lines_[line]));
    }
    const EndPoints merged_ends = merged(ends, length_, tolerance);
    node_of_ = merged_ends.node_of;
    leaving_.resize(merged_ends.at.size());
    for (std::size_t half = 0; half < node_of_.size(); ++half) leaving_[node_of_[half]].push_back(half);
    used_.assign(edges_.size(), false);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      auto& points = lines_[edges_[e]].points_m;
      const std::size_t from = node_of_[2 * e];
      const std::size_t to = node_of_[2 * e + 1];
      if (!(length_[e] > 0.0)) {  // a point
        used_[e] = true;
        const bool alone = leaving_[from].size() == 2;
        if (!alone) continue;
        out_.lines.push_back(std::move(lines_[edges_[e]]));
        out_.first.push_back(edges_[e]);
        continue;
      }
      if (leaving_[from].size() > 1) points.front() = merged_ends.at[from];
      if (leaving_[to].size() > 1) points.back() = merged_ends.at[to];
    }
    for (auto& halves : leaving_) std::erase_if(halves, [&](std::size_t half) { return used_[edge(half)]; });
  }

  Joined result() {
    keep_even();
    close();
    go_straight_on();
    return std::move(out_);
  }

 private:
  std::size_t node(std::size_t half) const { return node_of_[half]; }
  static std::size_t other(std::size_t half) { return half ^ 1U; }
  static std::size_t edge(std::size_t half) { return half / 2; }

  bool is_short(std::size_t half) const { return length_[edge(half)] <= 2.0 * tolerance_; }

  /// From the node into the line, some way on, so that a rounded end does not mislead.
  Vec2 direction(std::size_t half) const {
    const auto& p = lines_[edges_[edge(half)]].points_m;
    const bool front = half % 2 == 0;
    const Vec2& at = front ? p.front() : p.back();
    for (std::size_t i = 1; i < p.size(); ++i) {
      const Vec2 way = (front ? p[i] : p[p.size() - 1 - i]) - at;
      if (way.norm() > 2.0 * tolerance_ || i + 1 == p.size()) return way.normalized();
    }
    return Vec2::Zero();
  }

  /// Which edges can be part of a closed line: those that are no bridge (Tarjan, without recursion).
  std::vector<bool> on_rings() const {
    std::vector<bool> ring(edges_.size(), true);
    std::vector<std::size_t> seen(leaving_.size(), 0);
    std::vector<std::size_t> low(leaving_.size(), 0);
    struct Frame {
      std::size_t node, came_by, next;
    };
    std::size_t time = 0;
    for (std::size_t start = 0; start < leaving_.size(); ++start) {
      if (seen[start] != 0) continue;
      std::vector<Frame> stack{{start, kNone, 0}};
      seen[start] = low[start] = ++time;
      while (!stack.empty()) {
        Frame& f = stack.back();
        if (f.next < leaving_[f.node].size()) {
          const std::size_t half = leaving_[f.node][f.next++];
          if (edge(half) == f.came_by) continue;
          const std::size_t to = node(other(half));
          if (seen[to] == 0) {
            seen[to] = low[to] = ++time;
            stack.push_back({to, edge(half), 0});
          } else {
            low[f.node] = std::min(low[f.node], seen[to]);
          }
          continue;
        }
        const Frame done = f;
        stack.pop_back();
        if (stack.empty()) continue;
        low[stack.back().node] = std::min(low[stack.back().node], low[done.node]);
        if (low[done.node] > seen[stack.back().node]) ring[done.came_by] = false;
      }
    }
    return ring;
  }

  /// Marks what will be closed: rings without the shortest ways between their branches of an odd number.
  void keep_even() {
    closing_ = on_rings();
    std::vector<std::size_t> odd;
    for (std::size_t n = 0; n < leaving_.size(); ++n) {
      std::size_t degree = 0;
      for (const std::size_t half : leaving_[n]) degree += closing_[edge(half)] ? 1 : 0;
      if (degree % 2 == 1) odd.push_back(n);
    }
    std::vector<bool> waits(leaving_.size(), false);
    for (const std::size_t n : odd) waits[n] = true;
    for (const std::size_t n : odd) {
      if (waits[n]) take_out_shortest_way(n, waits);
    }
  }

  /// From one odd node to the nearest other that waits.
  void take_out_shortest_way(std::size_t from, std::vector<bool>& waits) {
    using Entry = std::tuple<double, std::size_t, std::size_t>;  // distance, node, half-edge that led here
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    std::vector<std::pair<std::size_t, std::size_t>> visited;
    queue.emplace(0.0, from, kNone);
    came_by_.resize(leaving_.size(), kNone);
    reached_.resize(leaving_.size(), false);
    std::size_t found = kNone;
    while (!queue.empty() && found == kNone) {
      const auto [distance, at, by] = queue.top();
      queue.pop();
      if (reached_[at]) continue;
      reached_[at] = true;
      came_by_[at] = by;
      visited.emplace_back(at, by);
      if (at != from && waits[at]) {
        found = at;
        break;
      }
      for (const std::size_t half : leaving_[at]) {
        const std::size_t to = node(other(half));
        if (closing_[edge(half)] && !reached_[to]) queue.emplace(distance + length_[edge(half)], to, half);
      }
    }
    waits[from] = false;
    if (found != kNone) {
      waits[found] = false;
      for (std::size_t at = found; at != from; at = node(came_by_[at])) closing_[edge(came_by_[at])] = false;
    }
    for (const auto& [at, by] : visited) reached_[at] = false;
  }

  /// Every node has an even number of closing edges: a walk comes back, and each loop on its way is a ring.
  void close() {
    std::vector<std::size_t> next(leaving_.size(), 0);
    std::vector<std::size_t> place(leaving_.size(), kNone);  // of a node on the walk
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (!closing_[e] || used_[e]) continue;
      std::vector<std::size_t> walk;  // half-edges
      std::size_t half = 2 * e;
      place[node(half)] = 0;
      while (half != kNone) {
        used_[edge(half)] = true;
        walk.push_back(half);
        const std::size_t at = node(other(half));
        if (place[at] != kNone) {
          const std::size_t first = place[at];
          const std::vector<std::size_t> ring(walk.begin() + static_cast<std::ptrdiff_t>(first), walk.end());
          for (const std::size_t h : ring) place[node(h)] = kNone;
          walk.resize(first);
          add(ring, true);
        }
        if (place[at] == kNone) place[at] = walk.size();
        half = next_on_ring(other(half), next[at]);
        if (half == kNone) place[at] = kNone;
      }
      if (!walk.empty()) add(walk, false);
    }
  }

  /// Straight on from where `arrived` leaves the way back; at a node of very many, any.
  std::size_t next_on_ring(std::size_t arrived, std::size_t& next) const {
    constexpr std::size_t kFew = 40;
    const auto& halves = leaving_[node(arrived)];
    const auto is_free = [&](std::size_t h) { return closing_[edge(h)] && !used_[edge(h)]; };
    if (halves.size() > kFew) {
      while (next < halves.size() && !is_free(halves[next])) ++next;
      return next < halves.size() ? halves[next] : kNone;
    }
    std::size_t best = kNone;
    double straightest = 2.0;
    for (const std::size_t h : halves) {
      if (!is_free(h)) continue;
      const double bend = halves.size() > 2 ? direction(arrived).dot(direction(h)) : 0.0;
      if (bend >= straightest) continue;
      straightest = bend;
      best = h;
    }
    return best;
  }

  /// What is left: at every node two and two, the straightest first.
  void go_straight_on() {
    std::vector<std::size_t> partner(2 * edges_.size(), kNone);
    for (const auto& halves : leaving_) {
      std::vector<std::pair<double, std::size_t>> by_angle;
      for (const std::size_t half : halves) {
        if (used_[edge(half)]) continue;
        const Vec2 d = direction(half);
        by_angle.emplace_back(std::atan2(d.y(), d.x()), half);
      }
      pair_up(by_angle, partner);
    }
    for (std::size_t start = 0; start < partner.size(); ++start) {
      if (used_[edge(start)] || partner[start] != kNone) continue;
      follow(start, partner);
    }
    for (std::size_t e = 0; e < edges_.size(); ++e) {  // only rings are left
      if (!used_[e]) follow(2 * e, partner);
    }
  }

  void pair_up(std::vector<std::pair<double, std::size_t>>& by_angle,
               std::vector<std::size_t>& partner) const {
    std::sort(by_angle.begin(), by_angle.end());
    const std::size_t n = by_angle.size();
    if (n < 2) return;
    std::vector<std::tuple<double, std::size_t, std::size_t>> candidates;
    const auto consider = [&](std::size_t i, std::size_t j) {
      if (i == j || edge(by_angle[i].second) == edge(by_angle[j].second)) return;
      const double apart = std::abs(by_angle[i].first - by_angle[j].first);
      // What is shorter than ends lie apart has no direction: it is taken last.
      const double last = is_short(by_angle[i].second) || is_short(by_angle[j].second) ? M_PI : 0.0;
      candidates.emplace_back(last + std::abs(M_PI - std::min(apart, 2.0 * M_PI - apart)), i, j);
    };
    constexpr std::size_t kFew = 40;  // all pairs; of more only those that lie about opposite
    for (std::size_t i = 0; i < n; ++i) {
      if (n <= kFew) {
        for (std::size_t j = i + 1; j < n; ++j) consider(i, j);
        continue;
      }
      const double opposite = by_angle[i].first + (by_angle[i].first > 0.0 ? -M_PI : M_PI);
      const auto at = static_cast<std::size_t>(
          std::lower_bound(by_angle.begin(), by_angle.end(), std::pair(opposite, std::size_t{0})) -
          by_angle.begin());
      for (std::size_t k = 0; k < 4; ++k) consider(i, (at + n + k - 2) % n);
    }
    std::sort(candidates.begin(), candidates.end());
    std::vector<bool> taken(n, false);
    const auto take = [&](std::size_t i, std::size_t j) {
      taken[i] = taken[j] = true;
      partner[by_angle[i].second] = by_angle[j].second;
      partner[by_angle[j].second] = by_angle[i].second;
    };
    for (const auto& [turn, i, j] : candidates) {
      if (!taken[i] && !taken[j]) take(i, j);
    }
    for (std::size_t i = 0, free = kNone; i < n; ++i) {  // those whose opposites have gone
      if (taken[i]) continue;
      if (free != kNone && edge(by_angle[free].second) != edge(by_angle[i].second)) {
        take(free, i);
        free = kNone;
      } else if (free == kNone) {
        free = i;
      }
    }
  }

  void follow(std::size_t half, const std::vector<std::size_t>& partner) {
    std::vector<std::size_t> chain;
    while (half != kNone && !used_[edge(half)]) {
      used_[edge(half)] = true;
      chain.push_back(half);
      half = partner[other(half)];
    }
    add(chain, node(chain.front()) == node(other(chain.back())));
  }

  void add(const std::vector<std::size_t>& chain, bool closed) {
    Polyline line;
    for (const std::size_t half : chain) {
      std::vector<Vec2> points = std::move(lines_[edges_[edge(half)]].points_m);
      if (half % 2 == 1) std::reverse(points.begin(), points.end());
      line.points_m.insert(line.points_m.end(), points.begin() + (line.points_m.empty() ? 0 : 1),
                           points.end());
    }
    out_.ends += 2 * (chain.size() - 1);
    // There and back is no ring.
    if (closed && line.size() > 3 && line.points_m.front() == line.points_m.back()) {
      line.points_m.pop_back();
      line.closed = true;
      out_.ends += 2;
    }
    out_.lines.push_back(std::move(line));
    out_.first.push_back(edges_[edge(chain.front())]);
  }

  std::vector<Polyline>& lines_;
  std::vector<std::size_t> edges_;
  double tolerance_;
  std::vector<std::size_t> node_of_;  ///< by half-edge
  std::vector<std::vector<std::size_t>> leaving_;
  std::vector<double> length_;
  std::vector<bool> closing_;
  std::vector<bool> used_;
  std::vector<bool> reached_;
  std::vector<std::size_t> came_by_;
  Joined out_;
};

/// An order that the file's does not matter for.
bool comes_before(const Polyline& a, const Polyline& b) {
  const auto key = [](const Polyline& line) {
    const Vec2& p = line.points_m.front();
    const Vec2& q = line.points_m.back();
    const bool forwards = std::tuple(p.x(), p.y()) <= std::tuple(q.x(), q.y());
    const Vec2& low = forwards ? p : q;
    const Vec2& high = forwards ? q : p;
    const Vec2& middle = line.points_m[line.size() / 2];
    return std::tuple(low.x(), low.y(), high.x(), high.y(), middle.x(), middle.y());
  };
  return key(a) < key(b);
}

}  // namespace

Joined joined(std::vector<Polyline> lines, double tolerance) {
  std::vector<std::size_t> open;
  Joined out;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].size() < 2) continue;
    if (!lines[i].closed) {
      open.push_back(i);
      continue;
    }
    out.lines.push_back(std::move(lines[i]));
    out.first.push_back(i);
  }
  std::stable_sort(open.begin(), open.end(),
                   [&](std::size_t a, std::size_t b) { return comes_before(lines[a], lines[b]); });
  Joined more = LineGraph(lines, open, tolerance).result();
  out.ends = more.ends;
  std::move(more.lines.begin(), more.lines.end(), std::back_inserter(out.lines));
  out.first.insert(out.first.end(), more.first.begin(), more.first.end());
  // As in the file, by where each begins.
  std::vector<std::size_t> order(out.lines.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return out.first[a] < out.first[b]; });
  Joined sorted;
  sorted.ends = out.ends;
  for (const std::size_t i : order) {
    sorted.lines.push_back(std::move(out.lines[i]));
    sorted.first.push_back(out.first[i]);
  }
  return sorted;
}

}  // namespace telekerf::vision
