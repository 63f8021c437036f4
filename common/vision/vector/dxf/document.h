// SPDX-License-Identifier: Apache-2.0
// A DXF file's sections -> lines.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "common/vision/vector/vector_drawing.h"

namespace telekerf::vision {

/// DXF (ASCII): LINE, LWPOLYLINE and POLYLINE with bulges, ARC, CIRCLE, ELLIPSE, SPLINE and INSERT of blocks
/// of these, in $INSUNITS, millimetres if unset. Whatever else is not followed is in `unsupported`.
tl::expected<VectorDrawing, std::string> read_dxf(std::string_view text, const VectorLimits& limits = {});

}  // namespace telekerf::vision
