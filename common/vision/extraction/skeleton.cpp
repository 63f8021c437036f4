// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/skeleton.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "common/vision/extraction/thinning.h"

namespace telekerf::vision {
namespace {

// Clockwise from north.
constexpr std::array<int, 8> kDx{0, 1, 1, 1, 0, -1, -1, -1};
constexpr std::array<int, 8> kDy{-1, -1, 0, 1, 1, 1, 0, -1};

/// Every x where a row is not zero; empty stretches are passed eight pixels at a time.
template <typename Visit>
void for_each_pixel(const unsigned char* row, int columns, const Visit& visit) {
  int x = 0;
  while (x < columns) {
    std::uint64_t eight = 0;
    if (x + 8 <= columns) {
      std::memcpy(&eight, row + x, 8);
      if (eight == 0) {
        x += 8;
        continue;
      }
    }
    for (const int end = std::min(x + 8, columns); x < end; ++x) {
      if (row[x] != 0) visit(x);
    }
  }
}

std::vector<cv::Point> pixels_of(const cv::Mat& image) {
  std::vector<cv::Point> out;
  for (int y = 0; y < image.rows; ++y) {
    for_each_pixel(image.ptr<unsigned char>(y), image.cols, [&](int x) { out.emplace_back(x, y); });
  }
  return out;
}

/// Neighbours in the sense of the graph: a diagonal one counts only when no straight neighbour leads there.
int graph_neighbours(const cv::Mat& s, cv::Point p, std::array<cv::Point, 8>& out) {
  std::array<bool, 8> on{};
  for (int i = 0; i < 8; ++i) {
    const int x = p.x + kDx[i];
    const int y = p.y + kDy[i];
    on[i] = x >= 0 && y >= 0 && x < s.cols && y < s.rows && s.at<unsigned char>(y, x) != 0;
  }
  int count = 0;
  for (int i = 0; i < 8; ++i) {
    if (!on[i] || (i % 2 == 1 && (on[i - 1] || on[(i + 1) % 8]))) continue;
    out[count++] = {p.x + kDx[i], p.y + kDy[i]};
  }
  return count;
}

/// Where two strokes meet in a sharp corner their ink grows together, and thinning leaves one line from where
/// they meet to the corner, along the bisector.
bool is_corner_spur(const SkeletonGraph& graph, std::size_t spur, int junction, double half_width) {
  std::vector<Vec2> others;
  Vec2 own = Vec2::Zero();
  const Vec2 at = graph.nodes[junction].position();
  const auto reach = static_cast<std::size_t>(4.0 * half_width) + 3;
  const double length = static_cast<double>(graph.lines[spur].pixels.size());
  if (length > 7.0 * half_width + 2.0 || graph.nodes[junction].degree != 3) return false;
  for (std::size_t i = 0; i < graph.lines.size(); ++i) {
    const SkeletonGraph::Line& line = graph.lines[i];
    for (const bool at_to : {false, true}) {
      if ((at_to ? line.to : line.from) != junction || line.pixels.empty()) continue;
      const std::size_t n = line.pixels.size();
      const std::size_t k = std::min(reach, n - 1);
      const cv::Point& p = at_to ? line.pixels[n - 1 - k] : line.pixels[k];
      const Vec2 direction = (Vec2(p.x, p.y) - at).normalized();
      if (i == spur) {
        own = direction;
      } else {
        if (static_cast<double>(n) < 1.5 * length) return false;
        others.push_back(direction);
      }
    }
  }
  if (others.size() != 2) return false;
  const Vec2 bisector = -(others[0] + others[1]);
  return others[0].dot(others[1]) > 0.0 && own.dot(bisector.normalized()) > 0.8;
}

}  // namespace

double half_width_at(const cv::Mat& drawn, const cv::Point& p) {
  const auto empty = [&](int x, int y) {
    return x < 0 || y < 0 || x >= drawn.cols || y >= drawn.rows || drawn.at<unsigned char>(y, x) == 0;
  };
  int best = std::numeric_limits<int>::max();                                    // squared
  for (int r = 0; r * r < best && r <= std::max(drawn.cols, drawn.rows); ++r) {  // rings of a square
    for (int i = -r; i <= r; ++i) {
      if (empty(p.x + i, p.y - r) || empty(p.x + i, p.y + r) || empty(p.x - r, p.y + i) ||
          empty(p.x + r, p.y + i))
        best = std::min(best, r * r + i * i);
    }
  }
  return std::sqrt(static_cast<double>(best));
}

Vec2 SkeletonGraph::Node::position() const {
  Vec2 sum = Vec2::Zero();
  for (const cv::Point& p : pixels) sum += Vec2(p.x, p.y);
  return sum / static_cast<double>(std::max<std::size_t>(1, pixels.size()));
}

SkeletonGraph graph_of(const cv::Mat& skeleton) {
  SkeletonGraph graph;
  const std::vector<cv::Point> on = pixels_of(skeleton);
  // Node of a pixel; -1: none yet, -2: on a line already walked. Only skeleton pixels are ever looked at.
  thread_local cv::Mat owner;  // kept: fresh memory of this size costs more than the walk
  owner.create(skeleton.size(), CV_32S);
  for (const cv::Point& p : on) owner.at<int>(p) = -1;
  std::array<cv::Point, 8> around;
  std::array<cv::Point, 8> further;
  // Nodes: ends alone, touching junction pixels together.
  for (const cv::Point& p : on) {
    if (owner.at<int>(p) != -1) continue;
    const int degree = graph_neighbours(skeleton, p, around);
    if (degree == 2) continue;
    const int id = static_cast<int>(graph.nodes.size());
    graph.nodes.push_back({{p}, 0});
    owner.at<int>(p) = id;
    if (degree < 2) continue;
    for (std::size_t i = 0; i < graph.nodes[id].pixels.size(); ++i) {
      const int count = graph_neighbours(skeleton, graph.nodes[id].pixels[i], around);
      for (int k = 0; k < count; ++k) {
        if (owner.at<int>(around[k]) != -1 || graph_neighbours(skeleton, around[k], further) < 3) continue;
        owner.at<int>(around[k]) = id;
        graph.nodes[id].pixels.push_back(around[k]);
      }
    }
  }
  const auto walk = [&](cv::Point before, cv::Point p, int from) {
    SkeletonGraph::Line line{{}, from, -1};
    while (true) {
      if (owner.at<int>(p) >= 0) {
        line.to = owner.at<int>(p);
        break;
      }
      if (owner.at<int>(p) == -2) break;  // a ring came round
      owner.at<int>(p) = -2;
      line.pixels.push_back(p);
      const int count = graph_neighbours(skeleton, p, around);
      cv::Point next = p;
      for (int k = 0; k < count; ++k) {
        if (around[k] != before) next = around[k];
      }
      if (next == p) break;
      before = p;
      p = next;
    }
    return line;
  };
  for (int id = 0; id < static_cast<int>(graph.nodes.size()); ++id) {
    for (const cv::Point& p : graph.nodes[id].pixels) {
      std::array<cv::Point, 8> exits;
      const int count = graph_neighbours(skeleton, p, exits);
      for (int k = 0; k < count; ++k) {
        const int other = owner.at<int>(exits[k]);
        if (other == id || other == -2) continue;
        if (other >= 0) {  // two nodes that touch: a line without pixels, once
          if (other > id) graph.lines.push_back({{}, id, other});
          continue;
        }
        graph.lines.push_back(walk(p, exits[k], id));
      }
    }
  }
  for (const cv::Point& p : on) {
    if (owner.at<int>(p) != -1) continue;
    const int count = graph_neighbours(skeleton, p, around);
    graph.lines.push_back(walk(count > 0 ? around[0] : p, p, -1));
  }
  for (const SkeletonGraph::Line& line : graph.lines) {
    if (line.from >= 0) ++graph.nodes[line.from].degree;
    if (line.to >= 0) ++graph.nodes[line.to].degree;
  }
  return graph;
}

SkeletonGraph pruned(SkeletonGraph graph, cv::Mat& skeleton, const cv::Mat& drawn) {
  for (int pass = 0; pass < 3; ++pass) {
    bool changed = false;
    for (std::size_t i = 0; i < graph.lines.size(); ++i) {
      const SkeletonGraph::Line& line = graph.lines[i];
      if (line.from < 0 || line.to < 0) continue;
      const auto& a = graph.nodes[line.from];
      const auto& b = graph.nodes[line.to];
      const bool from_end = a.degree == 1;
      if (from_end == (b.degree == 1)) continue;  // a stroke of its own, or no free end
      const auto& junction = from_end ? b : a;
      double grown = 0.0;
      for (const cv::Point& p : junction.pixels) grown = std::max(grown, half_width_at(drawn, p));
      const bool short_one = static_cast<double>(line.pixels.size()) <= 1.5 * grown + 2.0;
      if (!short_one && !is_corner_spur(graph, i, from_end ? line.to : line.from, grown)) continue;
      for (const cv::Point& p : line.pixels) skeleton.at<unsigned char>(p) = 0;
      for (const cv::Point& p : (from_end ? a : b).pixels) skeleton.at<unsigned char>(p) = 0;
      changed = true;
    }
    if (!changed) break;
    skeleton = thinned(skeleton);  // a junction that lost its branch may be two pixels thick
    graph = graph_of(skeleton);
  }
  return graph;
}

}  // namespace telekerf::vision
