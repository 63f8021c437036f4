// SPDX-License-Identifier: Apache-2.0
// Drawings to extract, and how far extracted points lie from the drawing they came from, and whether they run
// along it in order.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "common/geometry/nearest.h"
#include "common/vision/extraction/pixel_contour.h"
#include "tools/draw-pictures/rendering.h"

namespace telekerf::vision {

struct Comparison {
  double rms_px = 0.0;
  double mean_px = 0.0;    ///< points to truth, to the left of its direction positive
  double max_px = 0.0;     ///< points to truth
  double missed_px = 0.0;  ///< truth to points: what was left out
  double length_ratio = 0.0;
  double backwards = 0.0;  ///< share of steps that run against the drawing (in its direction, or all against)
  double once = 0.0;       ///< share of the truth's length covered in order, following it without a jump
};

/// Follows the truth with a local search, so that a crossing is passed twice, each time on its own branch.
inline Comparison compare(const PixelContour& contour, const geometry::Polyline& truth) {
  const geometry::NearestIndex ideal(truth);
  const geometry::NearestIndex found({contour.points_px, contour.closed});
  Comparison out;
  double squares = 0.0;
  for (const Vec2& p : contour.points_px) {
    const geometry::Nearest foot = ideal.find(p);
    const double d = foot.distance_m;
    squares += d * d;
    out.mean_px += foot.signed_distance_m / static_cast<double>(contour.points_px.size());
    out.max_px = std::max(out.max_px, d);
  }
  out.rms_px = std::sqrt(squares / static_cast<double>(contour.points_px.size()));
  const geometry::Polyline even = geometry::resampled(truth, 1.0);
  for (const Vec2& p : even.points_m) out.missed_px = std::max(out.missed_px, found.find(p).distance_m);
  out.length_ratio = found.length_m() / ideal.length_m();

  geometry::Nearest at = ideal.find(contour.points_px.front());
  // At a crossing the first point may sit on the wrong branch: begin a little later where it is unambiguous.
  const std::size_t n = contour.points_px.size();
  const std::size_t begin = n / 7;
  at = ideal.find(contour.points_px[begin]);
  double travelled = 0.0;
  double forwards = 0.0;
  double against = 0.0;
  const std::size_t steps = contour.closed ? n : n - 1 - begin;
  for (std::size_t k = 1; k <= steps; ++k) {
    const auto next =
        ideal.find_near(contour.points_px[(begin + k) % n], at.segment, {.arc_m = 12.0, .segments = 400});
    double step = next.arc_length_m - at.arc_length_m;
    if (truth.closed && step > 0.5 * ideal.length_m()) step -= ideal.length_m();
    if (truth.closed && step < -0.5 * ideal.length_m()) step += ideal.length_m();
    travelled += step;
    (step >= 0.0 ? forwards : against) += std::abs(step);
    at = next;
  }
  out.backwards = std::min(forwards, against) / std::max(1e-9, forwards + against);
  out.once = std::abs(travelled) / (ideal.length_m() * static_cast<double>(steps) /
                                    static_cast<double>(contour.closed ? n : n - 1));
  return out;
}

/// Blur, noise and uneven light, other ones each round.
inline drawing::Appearance hard_appearance(int round) {
  drawing::Appearance appearance;
  appearance.blur_px = 1.2;
  appearance.noise = 8.0;
  appearance.shading = 20.0;
  appearance.seed = static_cast<std::uint64_t>(round) + 1;
  return appearance;
}

/// A shipped drawing at another angle, size and place each round.
inline drawing::Drawing turned(const std::string& name, int round) {
  return drawing::transformed(*drawing::by_name(name), 0.41 * round, 1.0 - 0.06 * round, {319.5, 239.5},
                              {3.3 * round, -2.1 * round});
}

}  // namespace telekerf::vision
