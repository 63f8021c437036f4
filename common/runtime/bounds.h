// SPDX-License-Identifier: Apache-2.0
// What a number may be: bounds and unit, the same words in help, refusals and reference.
#pragma once

#include <limits>
#include <string>

namespace telekerf {

/// Inclusive.
struct Bounds {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  const char* unit = "";  ///< as written after a number: "mm/s"; empty: a pure number, or its name says it
};

/// Of random numbers.
inline constexpr Bounds kSeeds{.min = 0, .max = 1e15};

/// What is wrong with `value`, and what it must be; empty: nothing.
std::string complaint_about(double value, const Bounds& bounds);

/// "100 to 10000 Hz", "at least 0", ""; for people.
std::string range_text(const Bounds& bounds);

}  // namespace telekerf
