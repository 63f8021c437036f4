// SPDX-License-Identifier: Apache-2.0
// Lines that lie on each other: what is drawn twice is cut once.
#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

struct WithoutDoubles {
  std::vector<geometry::Polyline> lines;
  std::vector<std::size_t> from;  ///< which of the given lines each is, or is part of
  std::vector<geometry::Polyline> doubles;
  std::vector<std::size_t> doubles_from;
  bool gave_up = false;  ///< too many lines in one place: nothing was looked for
};

/// Takes out what lies within `tolerance` of another line all along, up to where one of the two ends or turns
/// away at a corner: a line that only touches another stays whole. Closed lines are kept before open ones,
/// longer ones before shorter ones.
WithoutDoubles without_doubles(std::vector<geometry::Polyline> lines, double tolerance);

}  // namespace telekerf::vision
