// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/smoothing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace telekerf::geometry {

HalfKernel gaussian_kernel(double sigma) {
  HalfKernel out{std::vector<double>(static_cast<std::size_t>(std::ceil(4.0 * sigma)) + 1), 0.0};
  for (std::size_t k = 0; k < out.weights.size(); ++k) {
    out.weights[k] = std::exp(-0.5 * static_cast<double>(k * k) / (sigma * sigma));
    out.sum += (k == 0 ? 1.0 : 2.0) * out.weights[k];
  }
  return out;
}

std::vector<Vec2> convolved(const std::vector<Vec2>& points, bool closed,
                            const std::vector<double>& weights) {
  const auto n = static_cast<std::ptrdiff_t>(points.size());
  const auto half = static_cast<std::ptrdiff_t>(weights.size()) - 1;
  const auto at = [&](std::ptrdiff_t i) -> Vec2 {
    if (closed) return points[((i % n) + n) % n];
    if (i < 0) return 2.0 * points[0] - points[std::min(-i, n - 1)];
    if (i >= n) return 2.0 * points[n - 1] - points[std::max<std::ptrdiff_t>(2 * (n - 1) - i, 0)];
    return points[i];
  };
  std::vector<Vec2> out(points.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    Vec2 sum = weights[0] * points[i];
    if (i >= half && i + half < n) {
      for (std::ptrdiff_t k = 1; k <= half; ++k) sum += weights[k] * (points[i - k] + points[i + k]);
    } else {
      for (std::ptrdiff_t k = 1; k <= half; ++k) sum += weights[k] * (at(i - k) + at(i + k));
    }
    out[i] = sum;
  }
  return out;
}

std::vector<Vec2> gaussian_smoothed(const std::vector<Vec2>& points, bool closed, double sigma) {
  const HalfKernel kernel = gaussian_kernel(sigma);
  std::vector<Vec2> out = convolved(points, closed, kernel.weights);
  for (Vec2& p : out) p /= kernel.sum;
  return out;
}

double smooth_keeping_bends(std::vector<Vec2>& points, bool closed, double sigma) {
  if (points.size() < 8 || !(sigma > 0.0)) return 0.0;
  HalfKernel kernel = gaussian_kernel(sigma);
  for (double& w : kernel.weights) w /= kernel.sum;
  std::vector<Vec2> once = convolved(points, closed, kernel.weights);
  std::vector<Vec2> rest(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) rest[i] = points[i] - once[i];
  const std::vector<Vec2> back = convolved(rest, closed, kernel.weights);
  double squares = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    once[i] += back[i];
    squares += (points[i] - once[i]).squaredNorm();
  }
  points = std::move(once);
  return std::sqrt(0.5 * squares / static_cast<double>(points.size()));  // one axis of two
}

}  // namespace telekerf::geometry
