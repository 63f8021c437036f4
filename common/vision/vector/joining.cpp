// SPDX-License-Identifier: Apache-2.0
#include "common/vision/vector/joining.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

namespace telekerf::vision {

std::vector<geometry::Polyline> joined(std::vector<geometry::Polyline> lines, double tolerance) {
  // Ends by cell of a grid; partners are looked for in the nine cells around.
  using Cell = std::pair<long long, long long>;
  const double size = std::max(4.0 * tolerance, 1e-12);
  const auto cell_of = [&](const Vec2& p) {
    return Cell{static_cast<long long>(std::floor(std::clamp(p.x() / size, -4e18, 4e18))),
                static_cast<long long>(std::floor(std::clamp(p.y() / size, -4e18, 4e18)))};
  };
  std::multimap<Cell, std::size_t> ends;
  std::vector<bool> open(lines.size(), false);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].closed || lines[i].size() < 2) continue;
    open[i] = true;
    ends.emplace(cell_of(lines[i].points_m.front()), i);
    ends.emplace(cell_of(lines[i].points_m.back()), i);
  }
  const auto partner = [&](const Vec2& at, std::size_t self, bool& at_front) -> std::size_t {
    const Cell middle = cell_of(at);
    for (long long dx = -1; dx <= 1; ++dx) {
      for (long long dy = -1; dy <= 1; ++dy) {
        auto [it, last] = ends.equal_range({middle.first + dx, middle.second + dy});
        while (it != last) {
          const std::size_t i = it->second;
          if (!open[i]) {  // used up: looked at once and never again, however many lines meet here
            it = ends.erase(it);
            continue;
          }
          ++it;
          if (i == self) continue;
          at_front = (lines[i].points_m.front() - at).norm() <= tolerance;
          if (at_front || (lines[i].points_m.back() - at).norm() <= tolerance) return i;
        }
      }
    }
    return lines.size();
  };
  std::vector<geometry::Polyline> out;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].closed || !open[i]) {
      if (lines[i].size() >= 2) out.push_back(std::move(lines[i]));
      continue;
    }
    open[i] = false;
    geometry::Polyline line = std::move(lines[i]);
    for (int side = 0; side < 2; ++side) {
      while ((line.points_m.front() - line.points_m.back()).norm() > tolerance || line.size() == 2) {
        bool at_front = false;
        const std::size_t next = partner(line.points_m.back(), i, at_front);
        if (next == lines.size()) break;
        open[next] = false;
        auto& more = lines[next].points_m;
        if (!at_front) std::reverse(more.begin(), more.end());
        line.points_m.insert(line.points_m.end(), more.begin() + 1, more.end());
        more.clear();
      }
      std::reverse(line.points_m.begin(), line.points_m.end());
    }
    if (line.size() > 3 && (line.points_m.front() - line.points_m.back()).norm() <= tolerance) {
      line.points_m.pop_back();
      line.closed = true;
    }
    out.push_back(std::move(line));
  }
  return out;
}

}  // namespace telekerf::vision
