// SPDX-License-Identifier: Apache-2.0
// The ends of lines, those that are near each other taken as one point.
#pragma once

#include <cstddef>
#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf::vision {

struct EndPoints {
  std::vector<std::size_t> node_of;  ///< one a point that was given
  std::vector<Vec2> at;              ///< of each node: the middle of its points
};

/// Points within `tolerance` of each other, directly or through others, are one node.
EndPoints merged(const std::vector<Vec2>& points, double tolerance);

}  // namespace telekerf::vision
