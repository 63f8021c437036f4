// SPDX-License-Identifier: Apache-2.0
// One input for the readers of vector files: whatever the bytes, the answer is a drawing with lines or a
// sentence.
#pragma once

#include <cstdlib>
#include <string_view>

#include "common/vision/vector/dxf/document.h"
#include "common/vision/vector/svg/document.h"

namespace telekerf::vision {

inline void try_reader(std::string_view bytes, bool svg) {
  VectorLimits limits;
  limits.max_points = 20'000;
  limits.max_bytes = 1'000'000;
  const auto out = svg ? read_svg(bytes, limits) : read_dxf(bytes, limits);
  if (!out) {
    if (out.error().empty()) std::abort();
    return;
  }
  if (out->contours.empty()) std::abort();
  std::size_t points = 0;
  for (const auto& line : out->contours) {
    if (line.size() < 2 || !geometry::all_finite(line.points_m)) std::abort();
    points += line.size();
  }
  if (points > limits.max_points) std::abort();
}

}  // namespace telekerf::vision
