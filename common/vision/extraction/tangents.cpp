// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/tangents.h"

#include <algorithm>
#include <cmath>

namespace telekerf::vision {

std::vector<Vec2> tangents_of(const std::vector<Vec2>& p, bool closed, std::size_t reach) {
  const std::size_t n = p.size();
  std::vector<Vec2> out(n, Vec2::UnitX());
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t a = closed ? (i + n - reach % n) % n : i - std::min(i, reach);
    const std::size_t b = closed ? (i + reach) % n : std::min(n - 1, i + reach);
    const Vec2 d = p[b] - p[a];
    if (d.norm() > 0.0) out[i] = d.normalized();
  }
  return out;
}

}  // namespace telekerf::vision
