// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/end_points.h"

#include <algorithm>
#define BOOST_ALLOW_DEPRECATED_HEADERS  // Boost 1.74 includes its own old names
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <numeric>
#include <tuple>
#include <utility>

#include "common/geometry/polyline.h"

namespace telekerf::vision {
namespace {

namespace bgi = boost::geometry::index;
using TreePoint = boost::geometry::model::point<double, 2, boost::geometry::cs::cartesian>;
using TreeEntry = std::pair<TreePoint, std::size_t>;

/// Points that lie nowhere else: ends that are equal share one.
struct Places {
  std::vector<Vec2> at;  ///< from left to right
  std::vector<std::size_t> of_end;
};

Places places_of(const std::vector<Vec2>& ends) {
  std::vector<std::size_t> order(ends.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tuple(ends[a].x(), ends[a].y()) < std::tuple(ends[b].x(), ends[b].y());
  });
  Places out;
  out.of_end.resize(ends.size());
  for (const std::size_t i : order) {
    if (out.at.empty() || out.at.back() != ends[i]) out.at.push_back(ends[i]);
    out.of_end[i] = out.at.size() - 1;
  }
  return out;
}

/// Pairs of places within the tolerance, each with its nearest; the nearest pairs first.
std::vector<std::pair<std::size_t, std::size_t>> near_pairs(const std::vector<Vec2>& places,
                                                            double tolerance) {
  constexpr unsigned kNeighbours = 16;
  std::vector<TreeEntry> entries;
  for (std::size_t i = 0; i < places.size(); ++i)
    entries.emplace_back(TreePoint(places[i].x(), places[i].y()), i);
  const bgi::rtree<TreeEntry, bgi::quadratic<16>> tree(entries);
  std::vector<std::tuple<double, std::size_t, std::size_t>> found;
  std::vector<TreeEntry> nearest;
  for (const TreeEntry& here : entries) {
    nearest.clear();
    tree.query(bgi::nearest(here.first, kNeighbours + 1), std::back_inserter(nearest));
    for (const TreeEntry& other : nearest) {
      const double distance = (places[here.second] - places[other.second]).norm();
      if (distance > tolerance || other.second == here.second) continue;
      found.emplace_back(distance, std::min(here.second, other.second), std::max(here.second, other.second));
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::vector<std::pair<std::size_t, std::size_t>> out;
  for (const auto& [distance, a, b] : found) out.emplace_back(a, b);
  return out;
}

class Nodes {
 public:
  explicit Nodes(const Places& places)
      : parent_(places.at.size()), ends_(places.at.size(), 0), far_ends_(places.at.size()) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    for (const Vec2& p : places.at) boxes_.push_back({p, p});
    for (const std::size_t place : places.of_end) ++ends_[place];
  }
  /// Two places that are not to be one node.
  void keep_apart(std::size_t a, std::size_t b) {
    if (a == b) return;
    far_ends_[a].push_back(b);
    far_ends_[b].push_back(a);
  }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::size_t a, std::size_t b, double largest) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    if (far_ends_[a].size() < far_ends_[b].size()) std::swap(a, b);
    const geometry::Box box{boxes_[a].min.cwiseMin(boxes_[b].min), boxes_[a].max.cwiseMax(boxes_[b].max)};
    if (box.size().norm() > largest) return;
    // Where very short lines meet already, only an end that meets nothing yet is added.
    const bool loose = ends_[a] == 1 || ends_[b] == 1;
    if (!loose && !(far_ends_[a].empty() && far_ends_[b].empty())) return;
    for (const std::size_t far : far_ends_[b]) {
      if (root(far) == a) return;
    }
    parent_[b] = a;
    boxes_[a] = box;
    ends_[a] += ends_[b];
    far_ends_[a].insert(far_ends_[a].end(), far_ends_[b].begin(), far_ends_[b].end());
    far_ends_[b].clear();
  }
  const geometry::Box& box(std::size_t root) const { return boxes_[root]; }

 private:
  std::vector<std::size_t> parent_;
  std::vector<std::size_t> ends_;  ///< in each node
  std::vector<std::vector<std::size_t>> far_ends_;
  std::vector<geometry::Box> boxes_;
};

}  // namespace

EndPoints merged(const std::vector<Vec2>& ends, const std::vector<double>& lengths, double tolerance) {
  const Places places = places_of(ends);
  Nodes nodes(places);
  for (std::size_t e = 0; e < lengths.size(); ++e) {
    if (lengths[e] <= 2.0 * tolerance) nodes.keep_apart(places.of_end[2 * e], places.of_end[2 * e + 1]);
  }
  for (const auto& [a, b] : near_pairs(places.at, tolerance)) nodes.unite(a, b, 2.0 * tolerance);
  EndPoints out;
  std::vector<std::size_t> number(places.at.size(), places.at.size());
  for (std::size_t i = 0; i < places.at.size(); ++i) {
    const std::size_t root = nodes.root(i);
    if (number[root] == places.at.size()) {
      number[root] = out.at.size();
      const geometry::Box& box = nodes.box(root);
      out.at.push_back(box.min == box.max ? box.min : box.centre());
    }
    number[i] = number[root];
  }
  for (const std::size_t place : places.of_end) out.node_of.push_back(number[place]);
  return out;
}

}  // namespace telekerf::vision
