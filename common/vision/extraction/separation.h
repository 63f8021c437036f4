// SPDX-License-Identifier: Apache-2.0
// What of a picture is the drawing, and what its background.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "common/vision/extraction/fainter_parts.h"
#include "common/vision/extraction/outline.h"
#include "common/vision/raster/edge_evidence.h"
#include "common/vision/raster/field.h"

namespace telekerf::vision {

/// The complaint about a picture of which no shape is whole.
inline constexpr const char* kAllCutOff =
    "every shape touches the picture's border, so none is whole; show the shape with background all around "
    "it";

/// One way to tell drawing from background, and what speaks for it.
struct Separation {
  Field field;
  Outlines outlines;
  std::optional<std::string> complaint;
  EdgeEvidence edges;
  bool flattened = false;   ///< lines across shadows: the field is not the picture's own grey
  bool stands_out = false;  ///< large enough to be what the picture is about

  double explained_with_fainter = 0.0;  ///< `edges.explained`, by either level
  std::optional<FainterParts> fainter;  ///< of the drawing; `outlines` holds none of them

  bool whole() const { return !complaint && stands_out; }
  double score() const { return edges.explained * field.contrast; }  ///< many edges on a clear border
};

/// Drawing and background of a picture. Where the first level finds no whole drawing or leaves sharp edges
/// over, a better one if there is any, or lines across shadows, whichever scores best; where it finds the lit
/// half of paper, the lines on it. The error is one sentence that says why the picture is no drawing on a
/// background.
tl::expected<Separation, std::string> separated(const cv::Mat& grey);
/// At that share of the way from background to drawing, and at no other level.
tl::expected<Separation, std::string> separated_at(const cv::Mat& grey, double share);

}  // namespace telekerf::vision
