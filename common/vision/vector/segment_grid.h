// SPDX-License-Identifier: Apache-2.0
// Which segments of different lines come near each other.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

struct Segment {
  std::size_t line = 0;
  std::size_t index = 0;
  Vec2 from = Vec2::Zero();
  Vec2 to = Vec2::Zero();
};

/// Calls `visit` for pairs of segments of different lines, among them all that come within `distance` of each
/// other, some of them more than once. False: there would be more than `max_pairs`, and it ended before.
bool for_near_segments(const std::vector<geometry::Polyline>& lines, double distance, std::size_t max_pairs,
                       const std::function<void(const Segment&, const Segment&)>& visit);

}  // namespace telekerf::vision
