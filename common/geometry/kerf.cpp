// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/kerf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/geometry/nearest.h"

namespace telekerf::geometry {
namespace {

constexpr double kSpacing_m = 10e-6;

}  // namespace

tl::expected<Polyline, std::string> compensated(const Polyline& contour, double kerf_m, bool hole) {
  if (!contour.closed || contour.size() < 3 || !(kerf_m > 0.0)) return contour;
  const double offset = 0.5 * kerf_m;
  const double outward = (signed_area_m2(contour) > 0.0 ? 1.0 : -1.0) * (hole ? -1.0 : 1.0);
  const NearestIndex index(contour);
  // Corners are kept, straights get dense points: of those beside an inner corner only the ones before the
  // moved corner survive.
  const double spacing = std::min(offset, kSpacing_m);
  Polyline dense{{}, true};
  for (std::size_t i = 0; i < contour.segments(); ++i) {
    const Vec2 way = contour.end_of(i) - contour.start_of(i);
    const auto pieces = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(way.norm() / spacing)));
    for (std::size_t k = 0; k < pieces; ++k) {
      dense.points_m.push_back(contour.start_of(i) +
                               static_cast<double>(k) / static_cast<double>(pieces) * way);
    }
  }
  Polyline out{{}, true};
  const std::size_t n = dense.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& here = dense.points_m[i];
    const Vec2 before = (here - dense.points_m[(i + n - 1) % n]).normalized();
    const Vec2 after = (dense.points_m[(i + 1) % n] - here).normalized();
    // At a sharp outer corner the way goes round it: as many points as the turn needs.
    const double turn = std::atan2(cross(before, after), before.dot(after));
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

std::string passed_by(const Polyline& contour, const Polyline& moved, double kerf_m) {
  if (!contour.closed || moved.size() < 2 || !(kerf_m > 0.0)) return {};
  const NearestIndex index(moved);
  double deepest = 0.0;
  for (const Vec2& p : resampled(contour, 0.25 * kerf_m).points_m)
    deepest = std::max(deepest, index.find(p).distance_m);
  if (deepest <= 1.5 * kerf_m) return {};
  return fmt::format(
      "a slot or notch narrower than the kerf of {:g} mm is not cut; the deepest is {:.2f} mm deep",
      kerf_m * 1e3, deepest * 1e3);
}

}  // namespace telekerf::geometry
