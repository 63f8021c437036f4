// SPDX-License-Identifier: Apache-2.0
// One entity of a DXF file: what its groups say, and the line that it draws.
#pragma once

#include <array>
#include <bitset>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/vectors.h"
#include "common/vision/vector/curve_writer.h"
#include "common/vision/vector/dxf/blocks.h"
#include "common/vision/vector/dxf/groups.h"
#include "common/vision/vector/spline.h"

namespace telekerf::vision {

struct DxfVertex {
  Vec2 at = Vec2::Zero();
  double bulge = 0.0;
  double z = 0.0;
  int flags = 0;
};

/// What an entity's groups say; only what some kind of line needs.
struct DxfEntity {
  std::string kind;
  std::string_view layer;           ///< 8
  std::string_view line_type;       ///< 6; empty: the layer's
  int colour = 256;                 ///< 62; 256: the layer's, 0: the block's
  long true_colour = -1;            ///< 420
  std::array<double, 60> number{};  ///< the last value of codes 10 .. 59
  std::bitset<60> given;            ///< which of them the file has
  int flags = 0;                    ///< 70
  bool invisible = false;           ///< 60 = 1
  bool on_sheet = false;            ///< 67 = 1: on the printed sheet, not in the drawing
  bool tilted = false;              ///< extruded neither up nor down
  bool extruded_down = false;       ///< 230 = -1: seen from below, x is mirrored
  double lowest_z = INFINITY;       ///< 30 and 31
  double highest_z = -INFINITY;     ///< likewise
  std::vector<DxfVertex> vertices;  ///< of polylines
  Spline spline;                    ///< of a SPLINE
  std::vector<Vec2> fit_points;     ///< of a SPLINE
  DxfInsert insert;                 ///< of an INSERT
};

/// Adds one group to the entity under construction; false when a number cannot be read.
bool absorb(DxfEntity& e, const DxfGroup& g);

/// What draws nothing of its own: windows onto the drawing, and marks of where something ends.
bool draws_nothing(const DxfEntity& e);

}  // namespace telekerf::vision
