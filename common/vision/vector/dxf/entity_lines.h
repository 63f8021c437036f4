// SPDX-License-Identifier: Apache-2.0
// The lines that the entities of a DXF file draw.
#pragma once

#include <Eigen/Geometry>

#include "common/vision/vector/drawn_lines.h"
#include "common/vision/vector/dxf/entity.h"

namespace telekerf::vision {

/// Draws LINE, CIRCLE, ARC, ELLIPSE, LWPOLYLINE, POLYLINE or SPLINE; another kind is noted as unsupported.
/// `here` places the entity's coordinates in the drawing.
void draw_entity(const DxfEntity& e, const Eigen::Affine2d& here, DrawnLines& out);

}  // namespace telekerf::vision
