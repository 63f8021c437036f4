// SPDX-License-Identifier: Apache-2.0
// Curves of vector files, cut into chords that stay within a given distance of the curve.
#pragma once

#include <cstddef>
#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf::vision {

/// A polyline under construction, in a file's units. Every `*_to` starts at the last point. Once `full`,
/// nothing is added.
class CurveWriter {
 public:
  CurveWriter(double chord_error, std::size_t max_points) : error_(chord_error), room_(max_points) {}

  bool full() const { return full_; }
  double chord_error() const { return error_; }
  bool bad() const { return bad_; }  ///< a coordinate was not finite
  const std::vector<Vec2>& points() const { return points_; }
  std::vector<Vec2> take();

  void move_to(const Vec2& p);
  void line_to(const Vec2& p);
  void quadratic_to(const Vec2& control, const Vec2& end);
  void cubic_to(const Vec2& a, const Vec2& b, const Vec2& end);
  /// Part of an ellipse: centre + major cos(t) + minor sin(t), from `from` to `to` radians.
  void ellipse(const Vec2& centre, const Vec2& major, const Vec2& minor, double from, double to);
  /// SVG's elliptical arc (F.6 of its specification), radii scaled up where they cannot reach.
  void arc_to(Vec2 radii, double rotation_rad, bool large, bool sweep, const Vec2& end);
  /// Circular arc with DXF's bulge, the tangent of a quarter of its angle; positive turns left.
  void bulge_to(double bulge, const Vec2& end);

 private:
  bool add(const Vec2& p);

  double error_;
  std::size_t room_;
  bool full_ = false;
  bool bad_ = false;
  std::vector<Vec2> points_;
};

}  // namespace telekerf::vision
