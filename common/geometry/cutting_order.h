// SPDX-License-Identifier: Apache-2.0
// In which order several contours are cut: what lies inside first, then the shorter way.
#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::geometry {

/// True when `inner` lies within the closed `outer` (their borders do not cross, so one point decides).
bool encloses(const Polyline& outer, const Polyline& inner);

/// For each contour: an odd number of the others lies around it.
std::vector<bool> holes(const std::vector<Polyline>& contours);

struct CuttingOrder {
  std::vector<std::size_t> order;  ///< indices into the given contours
  double travel_m = 0.0;           ///< beam off, from `start` on
};

/// A contour comes after everything inside it: cut the other way round, the piece would fall out first. Among
/// those that are free the nearest is next. Closed contours are entered at their first point.
CuttingOrder cutting_order(const std::vector<Polyline>& contours, const Vec2& start_m = Vec2::Zero());

}  // namespace telekerf::geometry
