// SPDX-License-Identifier: Apache-2.0
// Which of the drawn shapes are strokes and which are regions: a mode for each, not one for the picture.
#pragma once

#include "common/vision/extraction/outline.h"
#include "common/vision/raster/field.h"

namespace telekerf::vision {

/// What is drawn, told apart. The parts' `cut_off` is that of the whole, or 1 where something was taken out:
/// then only whole shapes are followed.
struct ShapeKinds {
  Outlines strokes;
  Outlines regions;
  cv::Mat stroke_ink;  ///< CV_8U, what is drawn without the regions; empty unless both kinds are there
};

/// A shape is a stroke when it is thin for its size, or a closed band of even width. A dot counts
/// as a region when it is much wider than the pen of the strokes beside it.
ShapeKinds kinds_of(const Field& field, const Outlines& outlines);

/// The largest shape has the same width all along, as a pen draws it.
bool is_of_one_pen(const Field& field, const Outlines& outlines);

}  // namespace telekerf::vision
