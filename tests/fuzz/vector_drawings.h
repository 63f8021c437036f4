// SPDX-License-Identifier: Apache-2.0
// One input for the readers of vector files: whatever the bytes, the answer is a drawing with lines or a
// sentence.
#pragma once

#include <cstdlib>
#include <string>
#include <string_view>

#include "common/vision/vector/dxf/document.h"
#include "common/vision/vector/svg/document.h"

namespace telekerf::vision {

/// What is wrong with the answer; empty: nothing.
inline std::string trouble_of(std::string_view bytes, bool svg) {
  VectorLimits limits;
  limits.max_points = 20'000;
  limits.max_bytes = 1'000'000;
  const auto out = svg ? read_svg(bytes, limits) : read_dxf(bytes, limits);
  if (!out) return out.error().empty() ? "a refusal without a sentence" : "";
  if (out->contours.empty()) return "a drawing without a line";
  std::size_t points = 0;
  for (const auto& line : out->contours) {
    if (line.size() < 2) return "a line without a length";
    if (!geometry::all_finite(line.points_m)) return "a point that is nowhere";
    points += line.size();
  }
  return points > limits.max_points ? "more points than are allowed" : "";
}

inline void try_reader(std::string_view bytes, bool svg) {
  if (!trouble_of(bytes, svg).empty()) std::abort();
}

}  // namespace telekerf::vision
