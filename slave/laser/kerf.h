// SPDX-License-Identifier: Apache-2.0
// The width of the cut: measured on the height map, and compensated by moving the path to the waste's side.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "common/geometry/polyline.h"
#include "slave/laser/height_map.h"

namespace telekerf::laser {

struct MarkAlongPath {
  double kerf_m = 0.0;           ///< mean width of what is deeper than half the mean depth
  double depth_m = 0.0;          ///< mean depth on the path
  double depth_variation = 0.0;  ///< largest deviation from the mean depth, as a share
};

/// Looks across the path at equal steps. Depths on the path are means over one spot's length, as a scratch of
/// that width would feel them.
MarkAlongPath measure_mark(const HeightMap& map, const geometry::Polyline& path, double spot_radius_m);

/// The closed contour moved by half the kerf: outwards (the piece inside keeps its size), or inwards for a
/// hole. Loops that the move makes at tight inner corners are cut off. An open line comes back as it is. An
/// error, one sentence: the contour is somewhere narrower than the kerf.
tl::expected<geometry::Polyline, std::string> compensated(const geometry::Polyline& contour, double kerf_m,
                                                          bool hole);

}  // namespace telekerf::laser
