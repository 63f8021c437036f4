// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/cutting_order.h"

#include <algorithm>
#define BOOST_ALLOW_DEPRECATED_HEADERS  // Boost 1.74 includes its own old names
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <cmath>
#include <set>
#include <utility>

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

namespace bgi = boost::geometry::index;
using TreePoint = boost::geometry::model::point<double, 2, boost::geometry::cs::cartesian>;
using TreeBox = boost::geometry::model::box<TreePoint>;
template <typename Shape>
using Tree = bgi::rtree<std::pair<Shape, std::size_t>, bgi::quadratic<16>>;

TreePoint tree_point(const Vec2& p) { return {p.x(), p.y()}; }

/// The contours around each: only those whose boxes hold its first point are looked at.
std::vector<std::vector<std::size_t>> contours_around(const std::vector<Polyline>& contours) {
  std::vector<std::pair<TreeBox, std::size_t>> boxes;
  for (std::size_t i = 0; i < contours.size(); ++i) {
    if (!contours[i].closed || contours[i].points_m.empty()) continue;
    const Box box = bounding_box(contours[i].points_m);
    boxes.emplace_back(TreeBox(tree_point(box.min), tree_point(box.max)), i);
  }
  const Tree<TreeBox> tree(boxes);
  std::vector<std::vector<std::size_t>> out(contours.size());
  for (std::size_t i = 0; i < contours.size(); ++i) {
    if (contours[i].points_m.empty()) continue;
    const auto here = bgi::intersects(tree_point(contours[i].points_m.front()));
    for (auto it = tree.qbegin(here); it != tree.qend(); ++it) {
      if (it->second != i && encloses(contours[it->second], contours[i])) out[i].push_back(it->second);
    }
    std::sort(out[i].begin(), out[i].end());
  }
  return out;
}

/// The value nearest to `at`; of several that are equally near the one with the smallest number.
std::pair<TreePoint, std::size_t> nearest(const Tree<TreePoint>& tree, const Vec2& at) {
  const TreePoint here = tree_point(at);
  std::pair<TreePoint, std::size_t> out = *tree.qbegin(bgi::nearest(here, 1));
  const double square = boost::geometry::comparable_distance(here, out.first);
  const Vec2 reach = Vec2::Constant(std::sqrt(square));
  const TreeBox around(tree_point(at - reach), tree_point(at + reach));
  for (auto it = tree.qbegin(bgi::intersects(around)); it != tree.qend(); ++it) {
    const bool as_near = boost::geometry::comparable_distance(here, it->first) <= square;
    if (as_near && it->second < out.second) out = *it;
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
  std::vector<std::pair<TreePoint, std::size_t>> free;
  std::set<std::size_t> waiting;
  for (std::size_t i = 0; i < n; ++i) {
    if (contours[i].points_m.empty()) {
      out.order.push_back(i);
    } else if (waiting_for[i] == 0) {
      free.emplace_back(tree_point(contours[i].points_m.front()), i);
    } else {
      waiting.insert(i);
    }
  }
  Tree<TreePoint> tree(free);
  const auto set_free = [&](std::size_t i) {
    waiting.erase(i);
    tree.insert({tree_point(contours[i].points_m.front()), i});
  };
  Vec2 at = start_m;
  while (out.order.size() < n) {
    // Borders that enclose each other do not exist, but never loop for ever.
    if (tree.empty()) set_free(*waiting.rbegin());
    const auto next = nearest(tree, at);
    tree.remove(next);
    out.order.push_back(next.second);
    for (const std::size_t j : around[next.second]) {
      if (--waiting_for[j] == 0 && waiting.count(j) > 0) set_free(j);
    }
    const Polyline& cut = contours[next.second];
    out.travel_m += (cut.points_m.front() - at).norm();
    at = cut.closed ? cut.points_m.front() : cut.points_m.back();
  }
  return out;
}

}  // namespace telekerf::geometry
