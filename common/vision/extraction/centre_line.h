// SPDX-License-Identifier: Apache-2.0
// The middle of a drawn stroke, finer than a pixel.
#pragma once

#include "common/vision/extraction/pixel_contour.h"
#include "common/vision/extraction/routes.h"
#include "common/vision/raster/field.h"

namespace telekerf::vision {

/// Moves each point to the middle between the stroke's two borders, bridges what lies within junctions by a
/// cubic, and sets free ends half a width inside the ink (the centre of a round pen). Returns the contour
/// unsmoothed.
PixelContour centred(const Field& field, const Route& route, double width_px);

}  // namespace telekerf::vision
