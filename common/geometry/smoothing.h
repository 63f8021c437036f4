// SPDX-License-Identifier: Apache-2.0
// Low-pass along evenly spaced points.
#pragma once

#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf::geometry {

/// Half of a symmetric kernel: weights at 0, 1, 2, ... spacings, and what they sum to over both sides.
struct HalfKernel {
  std::vector<double> weights;
  double sum = 1.0;
};
/// exp(-k^2 / 2 sigma^2) out to four deviations; sigma in spacings, above 0.
HalfKernel gaussian_kernel(double sigma);

/// Each point's weighted sum with its neighbours. A closed line wraps; an open one is continued by point
/// reflection at its ends, once, which keeps them and their direction as long as the kernel is shorter than
/// it.
std::vector<Vec2> convolved(const std::vector<Vec2>& points, bool closed, const std::vector<double>& weights);

/// Gaussian; sigma in spacings. Bends are flattened: a circle of radius r shrinks by about sigma^2 / 2 r.
std::vector<Vec2> gaussian_smoothed(const std::vector<Vec2>& points, bool closed, double sigma);

/// Twice a Gaussian minus its square, which leaves circles of more than a few spacings as they are; sigma in
/// spacings. What it took away, root mean square along one axis; fewer than eight points stay as they are.
double smooth_keeping_bends(std::vector<Vec2>& points, bool closed, double sigma);

}  // namespace telekerf::geometry
