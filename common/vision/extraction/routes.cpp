// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/routes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace telekerf::vision {
namespace {

constexpr double kMaxTurn_rad = 1.75;  ///< two branches that turn more than 100 degrees are not one stroke
constexpr double kForks = 0.8;         ///< cosine
constexpr double kMaxOverlap = 10.0;   ///< stroke widths

/// One end of one line.
struct End {
  int line = -1;
  bool at_to = false;
  Vec2 outwards = Vec2::Zero();  ///< direction away from the junction
};

int code(const End& end) { return 2 * end.line + (end.at_to ? 1 : 0); }

class Router {
 public:
  Router(const SkeletonGraph& graph, const cv::Mat& drawn, double width_px)
      : graph_(graph), drawn_(drawn), width_(width_px) {}

  std::vector<Route> routes() {
    join_clusters();
    pair_ends();
    std::vector<Route> out;
    for (int line = 0; line < static_cast<int>(graph_.lines.size()); ++line) {
      if (used_[line]) continue;
      out.push_back(follow(line));
    }
    return out;
  }

 private:
  int root(int node) const {
    while (cluster_[node] != node) node = cluster_[node];
    return node;
  }

  /// Nodes that belong to one crossing get one cluster; the lines within it vanish.
  void join_clusters() {
    cluster_.resize(graph_.nodes.size());
    std::iota(cluster_.begin(), cluster_.end(), 0);
    used_.assign(graph_.lines.size(), false);
    at_node_.resize(graph_.nodes.size());
    for (int i = 0; i < static_cast<int>(graph_.lines.size()); ++i) {
      const SkeletonGraph::Line& line = graph_.lines[i];
      if (line.from >= 0) at_node_[line.from].push_back(code({i, false, {}}));
      if (line.to >= 0) at_node_[line.to].push_back(code({i, true, {}}));
    }
    for (std::size_t i = 0; i < graph_.lines.size(); ++i) {
      const SkeletonGraph::Line& line = graph_.lines[i];
      if (line.from < 0 || line.to < 0 || line.from == line.to) continue;
      if (graph_.nodes[line.from].degree < 3 || graph_.nodes[line.to].degree < 3) continue;
      const auto length = static_cast<double>(line.pixels.size());
      if (forks(line, false) && forks(line, true) && length <= kMaxOverlap * width_) {
        cluster_[root(line.from)] = root(line.to);
        used_[i] = true;
        continue;
      }
      if (length > 5.0 * width_) continue;
      if (length <= 1.2 * width_ + 1.0 || stays_thick(line)) {
        cluster_[root(line.from)] = root(line.to);
        used_[i] = true;
      }
    }
  }

  /// The ink along the whole line is wider than one stroke. A pixel's half width says something about its
  /// neighbours' as well.
  bool stays_thick(const SkeletonGraph::Line& line) const {
    const double thick = 0.58 * width_;
    for (std::size_t i = 0; i < line.pixels.size();) {
      const double half_width = half_width_at(drawn_, line.pixels[i]);
      if (half_width <= thick) return false;
      i += 1 + static_cast<std::size_t>((half_width - thick) / std::sqrt(2.0));
    }
    return true;
  }

  /// The two other lines at this end of `line` run on as it came: two strokes that had lain on each other.
  bool forks(const SkeletonGraph::Line& line, bool at_to) const {
    const int node = at_to ? line.to : line.from;
    if (graph_.nodes[node].degree != 3 || line.pixels.size() < 2) return false;
    const int self = static_cast<int>(&line - graph_.lines.data());
    const Vec2 onwards = -outwards({self, at_to, {}});
    int ends = 0;
    for (const int end_code : at_node_[node]) {
      const End other{end_code / 2, end_code % 2 == 1, {}};
      if (other.line == self) continue;
      if (static_cast<double>(graph_.lines[other.line].pixels.size()) < 3.0 * width_) return false;
      if (outwards(other).dot(onwards) < kForks) return false;
      ++ends;
    }
    return ends == 2;
  }

  Vec2 point(const End& end, std::size_t steps) const {
    const auto& pixels = graph_.lines[end.line].pixels;
    const std::size_t i = std::min(steps, pixels.size() - 1);
    const cv::Point& p = end.at_to ? pixels[pixels.size() - 1 - i] : pixels[i];
    return {double(p.x), double(p.y)};
  }

  /// Direction away from the junction: within about one width of it the thinned line leans towards it.
  Vec2 outwards(const End& end) const {
    const std::size_t last = graph_.lines[end.line].pixels.size() - 1;
    const auto near = static_cast<std::size_t>(std::lround(0.8 * width_));
    const auto far = static_cast<std::size_t>(std::lround(2.5 * width_)) + 3;
    const Vec2 d = point(end, std::min(far, last)) - point(end, std::min(near, last / 2));
    return d.norm() > 0.0 ? Vec2(d.normalized()) : d;
  }

  /// Straightest pairs first is not always best: with four ends all three pairings are tried.
  void pair_ends() {
    partner_.assign(2 * graph_.lines.size(), -1);
    std::vector<std::vector<End>> meeting(graph_.nodes.size());
    for (int i = 0; i < static_cast<int>(graph_.lines.size()); ++i) {
      const SkeletonGraph::Line& line = graph_.lines[i];
      if (used_[i] || line.from < 0 || line.to < 0) continue;
      for (const bool at_to : {false, true}) {
        End end{i, at_to};
        if (!line.pixels.empty()) end.outwards = outwards(end);
        meeting[root(at_to ? line.to : line.from)].push_back(end);
      }
    }
    for (std::vector<End>& ends : meeting) {
      if (ends.size() == 2) {
        join(ends[0], ends[1]);
      } else if (ends.size() == 4) {
        constexpr std::array<std::array<int, 4>, 3> kPairings{{{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}}};
        const auto cost = [&](const std::array<int, 4>& p) {
          return turn(ends[p[0]], ends[p[1]]) + turn(ends[p[2]], ends[p[3]]);
        };
        const auto& best = *std::min_element(kPairings.begin(), kPairings.end(),
                                             [&](const auto& a, const auto& b) { return cost(a) < cost(b); });
        for (const int first : {0, 2}) {
          const End& a = ends[best[first]];
          const End& b = ends[best[first + 1]];
          if (turn(a, b) < kMaxTurn_rad) join(a, b);
        }
      } else {
        pair_greedily(ends);
      }
    }
  }

  static double turn(const End& a, const End& b) {
    return std::acos(std::clamp(-a.outwards.dot(b.outwards), -1.0, 1.0));
  }

  void join(const End& a, const End& b) {
    partner_[code(a)] = code(b);
    partner_[code(b)] = code(a);
  }

  void pair_greedily(std::vector<End> ends) {
    while (ends.size() >= 2) {
      std::pair<std::size_t, std::size_t> best{0, 0};
      double best_turn = kMaxTurn_rad;
      for (std::size_t i = 0; i < ends.size(); ++i) {
        for (std::size_t j = i + 1; j < ends.size(); ++j) {
          if (turn(ends[i], ends[j]) >= best_turn) continue;
          best_turn = turn(ends[i], ends[j]);
          best = {i, j};
        }
      }
      if (best.second == 0) return;
      join(ends[best.first], ends[best.second]);
      ends.erase(ends.begin() + best.second);
      ends.erase(ends.begin() + best.first);
    }
  }

  Route follow(int line) {
    // Back to where the stroke begins, unless it runs in a circle.
    int enter = 2 * line;  // the end by which the line is entered
    const int first = enter;
    bool closed = graph_.lines[line].from < 0;
    while (!closed && partner_[enter] >= 0) {
      enter = partner_[enter] ^ 1;
      if (enter == first) closed = true;
    }
    Route route;
    route.closed = closed;
    route.from_end = !closed && is_free(enter);
    const int begin = enter;
    while (true) {
      const int here = enter / 2;
      const SkeletonGraph::Line& l = graph_.lines[here];
      used_[here] = true;
      const bool backwards = enter % 2 == 1;
      const auto n = l.pixels.size();
      for (std::size_t i = 0; i < n; ++i) {
        const cv::Point& p = l.pixels[backwards ? n - 1 - i : i];
        const auto along = static_cast<double>(i);
        const double reach = 1.2 * width_;
        const bool at_start = joins(enter) && along < reach;
        const bool at_end = joins(enter ^ 1) && static_cast<double>(n - 1 - i) < reach;
        route.points_px.emplace_back(p.x, p.y);
        route.junction.push_back((at_start || at_end) && n > 2);
      }
      const int leave = enter ^ 1;
      if (partner_[leave] < 0) {
        route.to_end = !closed && is_free(leave);
        if (!closed) finish(route, begin, leave);
        return route;
      }
      enter = partner_[leave];
      if (enter == begin) return route;
    }
  }

  int node_of(int end_code) const {
    const SkeletonGraph::Line& l = graph_.lines[end_code / 2];
    return end_code % 2 == 1 ? l.to : l.from;
  }
  bool is_free(int end_code) const {
    return node_of(end_code) >= 0 && graph_.nodes[node_of(end_code)].degree == 1;
  }
  /// The end leads through a crossing (a corner with two ends is none).
  bool joins(int end_code) const {
    const int node = node_of(end_code);
    return node >= 0 && graph_.nodes[node].degree >= 3;
  }

  /// The node's own place at both ends of an open route.
  void finish(Route& route, int begin, int leave) {
    const auto add = [&](int end_code, bool in_front) {
      const int node = node_of(end_code);
      if (node < 0) return;
      const Vec2 at = graph_.nodes[node].position();
      route.points_px.insert(in_front ? route.points_px.begin() : route.points_px.end(), at);
      route.junction.insert(in_front ? route.junction.begin() : route.junction.end(), false);
    };
    add(begin, true);
    add(leave, false);
  }

  const SkeletonGraph& graph_;
  const cv::Mat& drawn_;
  double width_;
  std::vector<std::vector<int>> at_node_;  ///< codes of the ends that meet there
  std::vector<int> cluster_;
  std::vector<bool> used_;
  std::vector<int> partner_;
};

}  // namespace

std::vector<Route> routes_through(const SkeletonGraph& graph, const cv::Mat& drawn, double width_px) {
  return Router(graph, drawn, width_px).routes();
}

}  // namespace telekerf::vision
