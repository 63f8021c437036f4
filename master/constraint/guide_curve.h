// SPDX-License-Identifier: Apache-2.0
// The points that a hand can be guided along: contour / beta, evenly spaced, and no bend tighter than a tool
// can turn. Prepared outside the loop.
#pragma once

#include <algorithm>
#include <cstddef>

#include "common/geometry/polyline.h"
#include "common/protocol/messages.h"
#include "master/constraint/constraint_settings.h"

namespace telekerf::master {

/// The contour as it came, in the master's size and workpiece frame. Allocates.
geometry::Polyline scaled_contour(const ContourMessage& contour, double beta);

/// Master's workpiece frame. Allocates.
geometry::Polyline guide_curve(const ContourMessage& contour, double beta,
                               const ConstraintSettings& settings);

/// Index into a closed line, or the nearest one of an open line.
inline std::size_t index_of(const geometry::Polyline& line, long i) {
  const auto n = static_cast<long>(line.size());
  return static_cast<std::size_t>(line.closed ? ((i % n) + n) % n : std::clamp<long>(i, 0, n - 1));
}

}  // namespace telekerf::master
