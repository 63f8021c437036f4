// SPDX-License-Identifier: Apache-2.0
// One pass along the centre line of each drawn stroke: thinning, a graph, straight on at crossings, sub-pixel
// centring.
#pragma once

#include "common/vision/extraction/outline.h"
#include "common/vision/extraction/pixel_contour.h"
#include "common/vision/raster/field.h"

namespace telekerf::vision {

/// Centre lines of everything drawn, one pass each, crossings straight on; unsorted and unsmoothed.
Contours strokes_of(const Field& field, const Outlines& outlines);

}  // namespace telekerf::vision
