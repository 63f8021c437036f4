// SPDX-License-Identifier: Apache-2.0
// What a reader of vector files has drawn so far: lines in metres, within the limits, or why there are none.
#pragma once

#include <Eigen/Geometry>
#include <functional>
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
  DrawnLines(const VectorLimits& limits, const VectorRequest& request, const Vec2& metres)
      : limits_(limits), request_(request), metres_(metres) {}

  UnsupportedElements unsupported;
  Pen pen;                   ///< of what is drawn from now on
  std::string left_out_why;  ///< what is drawn from now on is not to be cut; empty: it is
  bool fills = false;        ///< what is drawn from now on is an area: it is closed where it has one
  std::vector<std::string> notes;

  /// The file cannot be drawn; the first reason counts. What is not to be cut may be damaged: it is counted.
  void fail(std::string sentence);
  bool failed() const { return !complaint_.empty(); }

  /// For a line in units that `here` places in the file's, as fine as its largest magnification asks for;
  /// nothing where no extent is left of it.
  std::optional<CurveWriter> writer(const Eigen::Affine2d& here);

  /// Takes the writer's line; a closed one that comes back to its start does not repeat it.
  void add(CurveWriter& writer, const Eigen::Affine2d& here, bool closed);

  /// What has been drawn since `count()` was `first`, for a reader that decides afterwards.
  std::size_t count() const { return lines_.size(); }
  const geometry::Polyline& line(std::size_t k) const { return lines_[k]; }
  void leave_out(std::size_t k, const std::string& why) { why_[k] = why; }
  /// A place of the file, in metres as the lines are.
  Vec2 placed(const Vec2& in_file) const { return metres_.cwiseProduct(in_file); }
  bool is_kept(std::size_t k) const { return why_[k].empty(); }

  /// All lines, those joined that meet; the error names the `format` where it is that there are none.
  tl::expected<VectorDrawing, std::string> drawing(std::string_view format);

 private:
  void choose();
  std::string none(std::string_view format, const VectorDrawing& drawing) const;

  VectorLimits limits_;
  VectorRequest request_;
  Vec2 metres_;
  std::size_t points_ = 0;
  std::vector<geometry::Polyline> lines_;
  std::vector<Pen> pens_;
  std::vector<std::string> why_;  ///< not to be cut
  std::size_t dots_ = 0;          ///< lines to be cut whose points are all one
  std::string complaint_;
};

}  // namespace telekerf::vision
