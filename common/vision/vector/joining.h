// SPDX-License-Identifier: Apache-2.0
// Lines that meet become one.
#pragma once

#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

/// Joins open lines whose ends coincide within `tolerance`, and closes those that come back to their start.
std::vector<geometry::Polyline> joined(std::vector<geometry::Polyline> lines, double tolerance);

}  // namespace telekerf::vision
