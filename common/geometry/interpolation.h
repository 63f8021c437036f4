// SPDX-License-Identifier: Apache-2.0
// Values between those of a table at equal steps.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace telekerf::geometry {

/// Linear, at `place` (counted in steps, clamped to the table, which holds two values or more).
inline double interpolated(std::span<const double> table, double place) noexcept {
  const double within = std::clamp(place, 0.0, static_cast<double>(table.size() - 1));
  const std::size_t i = std::min(static_cast<std::size_t>(within), table.size() - 2);
  return table[i] + (within - static_cast<double>(i)) * (table[i + 1] - table[i]);
}

}  // namespace telekerf::geometry
