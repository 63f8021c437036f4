// SPDX-License-Identifier: Apache-2.0
// A path as the straight and circular moves of a machine's controller.
#pragma once

#include <span>
#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf::vision {

/// One move from where the last one ended.
struct Move {
  Vec2 to_m;
  bool arc = false;
  Vec2 centre_m = Vec2::Zero();  ///< of an arc, which turns by at most half a circle
  bool clockwise = false;
};

/// The fewest moves, each taken as far as it reaches, that pass through the first and last point and within
/// `tolerance_m` of all others in between; `arcs` allows circular ones. Points in metres, no two neighbours
/// equal.
std::vector<Move> moves_along(std::span<const Vec2> points_m, double tolerance_m, bool arcs);

}  // namespace telekerf::vision
