// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "common/vision/extraction/contour_extraction.h"

namespace telekerf::vision {
namespace {

/// Gaussian along points that are one spacing apart. An open line is continued by point reflection at its
/// ends, which keeps the ends where they are.
std::vector<Vec2> filtered(const std::vector<Vec2>& p, bool closed, const std::vector<double>& kernel) {
  const auto n = static_cast<std::ptrdiff_t>(p.size());
  const auto half = static_cast<std::ptrdiff_t>(kernel.size()) - 1;
  const auto at = [&](std::ptrdiff_t i) -> Vec2 {
    if (closed) return p[((i % n) + n) % n];
    if (i < 0) return 2.0 * p[0] - p[std::min(-i, n - 1)];
    if (i >= n) return 2.0 * p[n - 1] - p[std::max<std::ptrdiff_t>(2 * (n - 1) - i, 0)];
    return p[i];
  };
  std::vector<Vec2> out(p.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    Vec2 sum = kernel[0] * p[i];
    if (i >= half && i + half < n) {
      for (std::ptrdiff_t k = 1; k <= half; ++k) sum += kernel[k] * (p[i - k] + p[i + k]);
    } else {
      for (std::ptrdiff_t k = 1; k <= half; ++k) sum += kernel[k] * (at(i - k) + at(i + k));
    }
    out[i] = sum;
  }
  return out;
}

}  // namespace

double smooth(std::vector<Vec2>& points, bool closed, double sigma) {
  if (points.size() < 8 || !(sigma > 0.0)) return 0.0;
  std::vector<double> kernel(static_cast<std::size_t>(std::ceil(4.0 * sigma)) + 1);
  double sum = 0.0;
  for (std::size_t k = 0; k < kernel.size(); ++k) {
    kernel[k] = std::exp(-0.5 * static_cast<double>(k * k) / (sigma * sigma));
    sum += (k == 0 ? 1.0 : 2.0) * kernel[k];
  }
  for (double& w : kernel) w /= sum;

  std::vector<Vec2> once = filtered(points, closed, kernel);
  std::vector<Vec2> rest(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) rest[i] = points[i] - once[i];
  const std::vector<Vec2> back = filtered(rest, closed, kernel);
  double squares = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    once[i] += back[i];
    squares += (points[i] - once[i]).squaredNorm();
  }
  points = std::move(once);
  return std::sqrt(0.5 * squares / static_cast<double>(points.size()));  // one axis of two
}

void smooth_and_resample(PixelContour& contour, double sigma_px) {
  const geometry::Polyline raw{std::move(contour.points_px), contour.closed};
  geometry::Polyline even = geometry::resampled(raw, 0.5);
  const double spacing =
      geometry::length_m(even) / static_cast<double>(std::max<std::size_t>(1, even.segments()));
  if (spacing > 0.0) contour.noise_px = smooth(even.points_m, even.closed, sigma_px / spacing);
  contour.points_px = geometry::resampled(even, 1.0).points_m;
}

}  // namespace telekerf::vision
