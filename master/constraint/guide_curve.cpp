// SPDX-License-Identifier: Apache-2.0
#include "master/constraint/guide_curve.h"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/geometry/circle_fit.h"

namespace telekerf::master {
namespace {

/// Gaussian average along the curve: no tool turns a corner of no radius. A right angle loses 0.57 `sigma_m`
/// of its tip, a bend of radius R moves inwards by sigma^2 / 2R.
geometry::Polyline rounded(const geometry::Polyline& line, double spacing_m, double sigma_m) {
  const long reach = std::lround(3.0 * sigma_m / spacing_m);
  if (reach < 1) return line;
  geometry::Polyline out = line;
  for (long i = 0; i < static_cast<long>(line.size()); ++i) {
    // Ends of an open line stay where they are: there the average is over fewer points.
    const long room = line.closed ? reach : std::min({reach, i, static_cast<long>(line.size()) - 1 - i});
    Vec2 sum = Vec2::Zero();
    double weights = 0.0;
    for (long j = -room; j <= room; ++j) {
      const double u = static_cast<double>(j) * spacing_m / sigma_m;
      const double weight = std::exp(-0.5 * u * u);
      sum += weight * line.points_m[index_of(line, i + j)];
      weights += weight;
    }
    out.points_m[index_of(line, i)] = sum / weights;
  }
  return out;
}

/// Curvature of the circle through three points; a turn by a right angle or more counts as a point.
double bend_at(const Vec2& before, const Vec2& here, const Vec2& after) noexcept {
  const Vec2 in = here - before;
  const Vec2 out = after - here;
  if (in.dot(out) <= 0.0) return std::numeric_limits<double>::infinity();
  return 2.0 * std::abs(geometry::cross(in, out)) / (in.norm() * out.norm() * (in + out).norm());
}

/// Bends no tighter than `radius_m`: where one is, the points move towards the middle of their neighbours
/// (the curve shortens) until it is open enough, or until they have moved by `most_m`: a hairpin without
/// width has no such bend. An average along the curve does not do it: it makes a cusp short, not round.
geometry::Polyline opened(geometry::Polyline line, double spacing_m, double radius_m, double most_m) {
  constexpr int kRounds = 3000;
  if (radius_m <= 0.0 || line.size() < 5) return line;
  std::vector<Vec2> start = line.points_m;
  bool changed = false;
  for (int round = 0; round < kRounds; ++round) {
    const auto n = static_cast<long>(line.size());
    const std::vector<Vec2> old = line.points_m;
    std::vector<Vec2> kept, kept_start;
    bool moved = false;
    bool dropped = false;
    for (long i = 0; i < n; ++i) {
      Vec2 here = old[static_cast<std::size_t>(i)];
      const Vec2 from = start[static_cast<std::size_t>(i)];
      const Vec2& before = old[index_of(line, i - 1)];
      const Vec2& after = old[index_of(line, i + 1)];
      const bool end = !line.closed && (i == 0 || i == n - 1);
      if (!end && bend_at(before, here, after) > 1.0 / radius_m) {
        const Vec2 next = 0.5 * here + 0.25 * (before + after);
        if ((next - from).norm() <= most_m) {
          here = next;
          moved = true;
          // Points that come too close together would stop the rest.
          dropped = !dropped && (after - before).norm() < 1.2 * spacing_m;
          if (dropped) {
            // How far the tip has come in is told from where it began.
            if (!kept_start.empty()) kept_start.back() = from;
            start[index_of(line, i + 1)] = from;
            continue;
          }
        }
      } else {
        dropped = false;
      }
      kept.push_back(here);
      kept_start.push_back(from);
    }
    if (!moved) break;
    changed = true;
    line.points_m = std::move(kept);
    start = std::move(kept_start);
  }
  return changed ? geometry::resampled(line, spacing_m) : line;
}

}  // namespace

geometry::Polyline scaled_contour(const ContourMessage& contour, double beta) {
  geometry::Polyline line{contour.points_m, contour.closed};
  for (Vec2& point_m : line.points_m) point_m /= beta;
  return line;
}

geometry::Polyline guide_curve(const ContourMessage& contour, double beta,
                               const ConstraintSettings& settings) {
  const geometry::Polyline even = geometry::resampled(scaled_contour(contour, beta), settings.spacing_m);
  const geometry::Polyline smooth = rounded(even, settings.spacing_m, settings.rounding_m);
  return opened(smooth, settings.spacing_m, settings.min_radius_m, settings.opening_m);
}

}  // namespace telekerf::master
