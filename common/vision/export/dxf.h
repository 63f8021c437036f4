// SPDX-License-Identifier: Apache-2.0
// Contours as a DXF file.
#pragma once

#include <span>
#include <string>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

/// Millimetres, a polyline a contour; closed ones are closed.
std::string to_dxf(std::span<const geometry::Polyline> contours);

}  // namespace telekerf::vision
