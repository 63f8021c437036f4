// SPDX-License-Identifier: Apache-2.0
#include "common/workpiece/mark_along_path.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "common/geometry/nearest.h"

namespace telekerf::workpiece {

MarkAlongPath measure_mark(const Workpiece& workpiece, const geometry::Polyline& path, double spot_radius_m) {
  const geometry::NearestIndex index(path);
  const double step = workpiece.pixel_m();
  // The ends of an open mark are round: half a spot of them is not on the way yet.
  const double margin = path.closed ? 0.0 : 2.0 * spot_radius_m;
  std::vector<double> depth;
  std::vector<geometry::Nearest> places;
  for (double s = margin; s < index.length_m() - margin; s += step) {
    places.push_back(index.at(s));
    depth.push_back(workpiece.depth_m(places.back().point_m));
  }
  MarkAlongPath mark;
  if (depth.empty()) return mark;
  for (const double d : depth) mark.depth_m += d / static_cast<double>(depth.size());
  const int half = std::max(1, static_cast<int>(spot_radius_m / step));
  const int count = static_cast<int>(depth.size());
  double worst = 0.0;
  for (int i = 0; i < count; ++i) {
    double sum = 0.0;
    int used = 0;
    for (int k = -half; k <= half; ++k) {
      int at = i + k;
      if (path.closed) at = (at + count) % count;
      if (at < 0 || at >= count) continue;
      sum += depth[static_cast<std::size_t>(at)];
      ++used;
    }
    worst = std::max(worst, std::abs(sum / used - mark.depth_m));
  }
  mark.depth_variation = mark.depth_m > 0.0 ? worst / mark.depth_m : 0.0;

  double width = 0.0;
  const double level = 0.5 * mark.depth_m;
  const double fine = 0.25 * step;
  for (const auto& place : places) {
    const Vec2 left(-place.tangent.y(), place.tangent.x());
    for (const double side : {1.0, -1.0}) {
      double reach = 0.0;
      while (reach < 4.0 * spot_radius_m && workpiece.depth_m(place.point_m + side * reach * left) > level)
        reach += fine;
      width += reach;
    }
  }
  mark.kerf_m = width / static_cast<double>(places.size());
  return mark;
}

}  // namespace telekerf::workpiece
