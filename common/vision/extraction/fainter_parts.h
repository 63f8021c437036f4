// SPDX-License-Identifier: Apache-2.0
// What is drawn fainter than half of the drawing: pencil beside ink, a paler part of a shape.
#pragma once

#include <optional>

#include "common/vision/extraction/outline.h"
#include "common/vision/raster/field.h"

namespace telekerf::vision {

struct FainterParts {
  Field field;        ///< drawn: these parts alone
  Outlines outlines;  ///< of whole ones
  cv::Mat darker;     ///< CV_8U, what was drawn before parts were taken out
  /// Across the outlines of the rest: what is drawn on something paler stands out less than on paper.
  double step = 0.0;
};

/// Shapes that show only nearer to the background's grey, with a clear outline. A darker part of such a shape
/// is taken out of `outlines` and of what is drawn in `field`; what is drawn within one stays.
std::optional<FainterParts> fainter_parts(Field& field, Outlines& outlines);

}  // namespace telekerf::vision
