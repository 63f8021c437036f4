// SPDX-License-Identifier: Apache-2.0
// Lines that meet become one.
#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

struct Joined {
  std::vector<geometry::Polyline> lines;
  std::vector<std::size_t> first;  ///< which of the given lines each begins with
  std::size_t ends = 0;            ///< that became one with another
};

/// Joins open lines whose ends lie within `tolerance` of each other, and closes those that come back to their
/// start. Where more than two meet, as much as can be is closed, and what is left goes straight on. The
/// result does not depend on the order of the lines, but for which of them are equal.
Joined joined(std::vector<geometry::Polyline> lines, double tolerance);

}  // namespace telekerf::vision
