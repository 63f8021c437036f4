// SPDX-License-Identifier: Apache-2.0
// How deep, even and wide a mark on the workpiece is.
#pragma once

#include "common/geometry/polyline.h"
#include "common/workpiece/workpiece.h"

namespace telekerf::workpiece {

struct MarkAlongPath {
  double kerf_m = 0.0;           ///< mean width of what is deeper than half the mean depth
  double depth_m = 0.0;          ///< mean depth on the path
  double depth_variation = 0.0;  ///< largest deviation from the mean depth, as a fraction
};

/// Looks across the path at equal steps. Depths on the path are means over one spot's length, as a scratch of
/// that width would feel them.
MarkAlongPath measure_mark(const Workpiece& workpiece, const geometry::Polyline& path, double spot_radius_m);

}  // namespace telekerf::workpiece
