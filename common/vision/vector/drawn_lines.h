// SPDX-License-Identifier: Apache-2.0
// What a reader of vector files has drawn so far: lines in metres, within the limits, or why there are none.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "common/vision/vector/curve_writer.h"
#include "common/vision/vector/unsupported_elements.h"
#include "common/vision/vector/vector_drawing.h"

namespace telekerf::vision {

class DrawnLines {
 public:
  /// `metres`: a unit of the file along x and y, negative where its axis points the other way.
  DrawnLines(const VectorLimits& limits, const Vec2& metres) : limits_(limits), metres_(metres) {}

  UnsupportedElements unsupported;

  /// The file cannot be drawn; the first reason counts.
  void fail(std::string sentence);
  bool failed() const { return !complaint_.empty(); }

  /// For a line in units that `here` places in the file's, as fine as its largest magnification asks for;
  /// nothing where no extent is left of it.
  std::optional<CurveWriter> writer(const Eigen::Affine2d& here);

  /// Takes the writer's line; a closed one that comes back to its start does not repeat it.
  void add(CurveWriter& writer, const Eigen::Affine2d& here, bool closed);

  /// All lines, those joined that meet; the error names the `format` where it is that there are none.
  tl::expected<VectorDrawing, std::string> drawing(std::string_view format);

 private:
  const VectorLimits& limits_;
  Vec2 metres_;
  std::size_t points_ = 0;
  std::vector<geometry::Polyline> lines_;
  std::string complaint_;
};

}  // namespace telekerf::vision
