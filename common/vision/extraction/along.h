// SPDX-License-Identifier: Apache-2.0
// Along a line through a picture: its directions, and the field beside it.
#pragma once

#include <cmath>
#include <vector>

#include "common/vision/extraction/contour_extraction.h"

namespace telekerf::vision {

/// The field between pixels, bilinear; far outside the picture it is background.
inline double field_at(const Field& field, const Vec2& p) {
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

/// Unit tangents of a line from the points `reach` before and after each.
std::vector<Vec2> tangents_of(const std::vector<Vec2>& p, bool closed, std::size_t reach);

}  // namespace telekerf::vision
