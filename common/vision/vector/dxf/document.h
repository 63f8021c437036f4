// SPDX-License-Identifier: Apache-2.0
// A DXF file's sections -> lines.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "common/vision/vector/vector_drawing.h"

namespace telekerf::vision {

/// DXF (ASCII): LINE, LWPOLYLINE and POLYLINE with bulges, ARC, CIRCLE, ELLIPSE, SPLINE and INSERT of blocks
/// of these, in $INSUNITS; if unset inches where $MEASUREMENT says so, millimetres otherwise. What is on a
/// layer that is frozen, off or not plotted is in `left_out`, whatever else is not followed in `unsupported`.
tl::expected<VectorDrawing, std::string> read_dxf(std::string_view bytes, const VectorLimits& limits = {},
                                                  const VectorRequest& request = {});

}  // namespace telekerf::vision
