// SPDX-License-Identifier: Apache-2.0
// What the picture's edges say of a split between drawing and background: a shadow that was taken for a
// drawing, or something drawn that was taken for background.
#pragma once

#include "common/vision/raster/field.h"

namespace telekerf::vision {

/// Looked at in some rows and columns only.
struct EdgeEvidence {
  /// Fraction of the sharp edges that lie on the border between drawing and background, 0 to 1. What was
  /// split along a shadow, or not split where it should be, leaves edges unexplained.
  double explained = 1.0;
  /// Clear edges between the background and something even that is fainter than half of the drawing; beside
  /// one edge of the drawing's own.
  double fainter = 0.0;
  /// Likewise of what lies off the background to the other side: light beside dark.
  double opposite = 0.0;
};
EdgeEvidence edge_evidence(const Field& field);

/// `explained`, where an edge may lie on another level as well.
double explained_by_either(const Field& field, double other_level);

/// The same picture split where it explains most edges: a shadow is no drawing where all that is drawn is
/// darker than it.
Field at_explaining_level(const Field& field);

/// The picture split nearer to the background.
struct FainterSplit {
  Field field;            ///< half way to what is faintest; its contrast is that of most of what is fainter
  double faintest = 0.0;  ///< contrast, grey levels
};
/// Slow changes of the light are taken out.
FainterSplit at_fainter_level(const Field& field);

}  // namespace telekerf::vision
