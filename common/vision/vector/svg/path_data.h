// SPDX-License-Identifier: Apache-2.0
// SVG's path data, the d attribute -> segments in absolute coordinates.
#pragma once

#include <optional>
#include <string_view>

#include "common/vision/vector/curve_writer.h"

namespace telekerf::vision {

/// One step of the pen. What is relative, level, upright or smooth in the data is spelt out.
struct PathSegment {
  enum class Kind { kMove, kLine, kQuadratic, kCubic, kArc, kClose };
  Kind kind = Kind::kMove;
  Vec2 from = Vec2::Zero();
  Vec2 to = Vec2::Zero();
  Vec2 a = Vec2::Zero();  ///< control point of a quadratic, first one of a cubic
  Vec2 b = Vec2::Zero();  ///< second control point of a cubic
  Vec2 radii = Vec2::Zero();
  double rotation_rad = 0.0;
  bool large = false;
  bool sweep = false;
};

/// The segments of a path, one after the other, read as they are asked for.
class PathData {
 public:
  explicit PathData(std::string_view d) : rest_(d) {}

  /// Nothing at the end, or where the data is `damaged`.
  std::optional<PathSegment> next();
  bool damaged() const { return damaged_; }
  std::string_view rest() const { return rest_; }  ///< what is not read yet

 private:
  bool take_command();
  bool take_operands(PathSegment& s);
  bool take_arc(PathSegment& s);
  bool take(double& value, double origin);
  bool take(Vec2& point) { return take(point.x(), at_.x()) && take(point.y(), at_.y()); }

  std::string_view rest_;
  char command_ = 0;  ///< in force, as it stands in the data
  char last_ = 0;     ///< kind of the segment before, in capitals
  Vec2 at_ = Vec2::Zero();
  Vec2 start_ = Vec2::Zero();
  Vec2 control_ = Vec2::Zero();  ///< of the last curve, for the smooth kinds
  bool damaged_ = false;
};

/// Draws a segment that is neither a move nor a close from the writer's last point.
void draw(const PathSegment& segment, CurveWriter& writer);

}  // namespace telekerf::vision
