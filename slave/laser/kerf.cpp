// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/kerf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace telekerf::laser {
namespace {

constexpr double kSpacing_m = 10e-6;

}  // namespace

MarkAlongPath measure_mark(const HeightMap& map, const geometry::Polyline& path, double spot_radius_m) {
  const geometry::NearestIndex index(path);
  const double step = map.pixel_m();
  // The ends of an open mark are round: half a spot of them is not on the way yet.
  const double margin = path.closed ? 0.0 : 2.0 * spot_radius_m;
  std::vector<double> depth;
  std::vector<geometry::Nearest> places;
  for (double s = margin; s < index.length_m() - margin; s += step) {
    places.push_back(index.at(s));
    depth.push_back(map.depth_at(places.back().point_m));
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
      while (reach < 4.0 * spot_radius_m && map.depth_at(place.point_m + side * reach * left) > level)
        reach += fine;
      width += reach;
    }
  }
  mark.kerf_m = width / static_cast<double>(places.size());
  return mark;
}

tl::expected<geometry::Polyline, std::string> compensated(const geometry::Polyline& contour, double kerf_m,
                                                          bool hole) {
  if (!contour.closed || contour.size() < 3 || !(kerf_m > 0.0)) return contour;
  const double offset = 0.5 * kerf_m;
  const double outward = (geometry::signed_area_m2(contour) > 0.0 ? 1.0 : -1.0) * (hole ? -1.0 : 1.0);
  const geometry::NearestIndex index(contour);
  // Corners are kept, straights get dense points: of those beside an inner corner only the ones before the
  // moved corner survive.
  const double spacing = std::min(offset, kSpacing_m);
  geometry::Polyline dense{{}, true};
  for (std::size_t i = 0; i < contour.segments(); ++i) {
    const Vec2 way = contour.end_of(i) - contour.start_of(i);
    const auto pieces = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(way.norm() / spacing)));
    for (std::size_t k = 0; k < pieces; ++k) {
      dense.points_m.push_back(contour.start_of(i) +
                               static_cast<double>(k) / static_cast<double>(pieces) * way);
    }
  }
  geometry::Polyline out{{}, true};
  const std::size_t n = dense.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& here = dense.points_m[i];
    const Vec2 before = (here - dense.points_m[(i + n - 1) % n]).normalized();
    const Vec2 after = (dense.points_m[(i + 1) % n] - here).normalized();
    // At a sharp outer corner the way goes round it: as many points as the turn needs.
    const double turn = std::atan2(geometry::cross(before, after), before.dot(after));
    const int pieces = turn * outward > 0.0 ? 1 + static_cast<int>(std::abs(turn) / 0.2) : 1;
    for (int k = 0; k < pieces; ++k) {
      const double angle = pieces == 1 ? 0.5 * turn : turn * k / (pieces - 1);
      const Vec2 t(before.x() * std::cos(angle) - before.y() * std::sin(angle),
                   before.x() * std::sin(angle) + before.y() * std::cos(angle));
      const Vec2 moved = here + outward * offset * Vec2(t.y(), -t.x());
      // Nearer to another part of the contour than the offset: part of a loop.
      if (index.find(moved).distance_m > offset * (1.0 - 1e-3)) out.points_m.push_back(moved);
    }
  }
  // Where it is too narrow for the beam the moved line is gone, or it jumps across.
  bool narrow = out.size() < 3;
  for (std::size_t i = 0; i < out.segments() && !narrow; ++i) {
    const Vec2 middle = 0.5 * (out.start_of(i) + out.end_of(i));
    narrow = index.find(middle).distance_m < 0.9 * offset;
  }
  if (narrow) {
    return tl::unexpected(fmt::format(
        "it is somewhere narrower than the kerf of {:g} mm; use a smaller --kerf-um", kerf_m * 1e3));
  }
  return out;
}

}  // namespace telekerf::laser
