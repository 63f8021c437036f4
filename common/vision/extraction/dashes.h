// SPDX-License-Identifier: Apache-2.0
// Dashed lines in a picture: they are not joined, but who cuts them should know.
#pragma once

#include "common/vision/extraction/pixel_contour.h"

namespace telekerf::vision {

/// How many of the contours are dashes of one line, or of several: short open strokes of much the same length
/// that follow each other. 0: there are too few to be one.
int dashes_in(const Contours& contours);

}  // namespace telekerf::vision
