// SPDX-License-Identifier: Apache-2.0
// The way along an edge, moved onto it.
#pragma once

#include "common/vision/extraction/pixel_contour.h"
#include "common/vision/extraction/routes.h"
#include "common/vision/raster/field.h"

namespace telekerf::vision {

/// Moves each point of a way along an edge onto the border between drawing and background.
PixelContour on_border(const Field& field, const Route& route);

}  // namespace telekerf::vision
