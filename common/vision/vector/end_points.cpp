// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/end_points.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace telekerf::vision {

EndPoints merged(const std::vector<Vec2>& points, double tolerance) {
  const std::size_t n = points.size();
  std::vector<std::size_t> parent(n);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  // From left to right; many points of one place are a chain of equal neighbours.
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tuple(points[a].x(), points[a].y()) < std::tuple(points[b].x(), points[b].y());
  });
  // Rows as high as the tolerance; the last points of this row and its neighbours are all that can be near.
  struct Place {
    long long row;
    std::size_t point;
  };
  const double height = std::max(tolerance, 1e-12);
  std::vector<Place> places;
  places.reserve(n);
  for (const std::size_t i : order) {
    places.push_back(
        {static_cast<long long>(std::floor(std::clamp(points[i].y() / height, -4e18, 4e18))), i});
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.row < b.row; });
  const auto near = [&](std::size_t a, std::size_t b) { return (points[a] - points[b]).norm() <= tolerance; };
  std::size_t below = 0;  // first place of the row below
  for (std::size_t begin = 0; begin < n;) {
    std::size_t end = begin;
    while (end < n && places[end].row == places[begin].row) ++end;
    const bool neighbours = begin > below && places[below].row + 1 == places[begin].row;
    std::size_t window = below;
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t i = places[k].point;
      // Of those in its own row one is enough, as long as it is near: the others hang on it.
      for (std::size_t j = k; j-- > begin && points[i].x() - points[places[j].point].x() <= tolerance;) {
        if (!near(i, places[j].point)) continue;
        parent[root(i)] = root(places[j].point);
        if (points[i].x() - points[places[j].point].x() <= 0.0) break;
      }
      if (!neighbours) continue;
      while (window < begin && points[places[window].point].x() < points[i].x() - tolerance) ++window;
      for (std::size_t j = window; j < begin && points[places[j].point].x() <= points[i].x() + tolerance;
           ++j) {
        if (root(places[j].point) != root(i) && near(i, places[j].point))
          parent[root(i)] = root(places[j].point);
      }
    }
    below = begin;
    begin = end;
  }
  EndPoints out;
  out.node_of.assign(n, n);
  std::vector<std::size_t> number(n, n);
  std::vector<std::size_t> count;
  std::vector<Vec2> low;
  std::vector<Vec2> high;
  for (const std::size_t i : order) {
    std::size_t& node = number[root(i)];
    if (node == n) {
      node = low.size();
      low.push_back(points[i]);
      high.push_back(points[i]);
    }
    low[node] = low[node].cwiseMin(points[i]);
    high[node] = high[node].cwiseMax(points[i]);
    out.node_of[i] = node;
  }
  for (std::size_t k = 0; k < low.size(); ++k)
    out.at.push_back(low[k] == high[k] ? low[k] : Vec2(0.5 * (low[k] + high[k])));
  return out;
}

}  // namespace telekerf::vision
