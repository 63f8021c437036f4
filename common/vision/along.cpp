// SPDX-License-Identifier: Apache-2.0
#include "common/vision/along.h"

#include <algorithm>
#include <cmath>

namespace telekerf::vision {

double field_at(const Field& field, const Vec2& p) {
  const int x = static_cast<int>(std::floor(p.x()));
  const int y = static_cast<int>(std::floor(p.y()));
  if (x < 0 || y < 0 || x + 1 >= field.smooth.cols || y + 1 >= field.smooth.rows) return -1.0;
  const double u = p.x() - x;
  const double v = p.y() - y;
  const auto* upper = field.smooth.ptr<unsigned char>(y) + x;
  const auto* lower = field.smooth.ptr<unsigned char>(y + 1) + x;
  const double grey =
      (1 - v) * (upper[0] + u * (upper[1] - upper[0])) + v * (lower[0] + u * (lower[1] - lower[0]));
  return field.dark ? field.level - grey : grey - field.level;
}

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
