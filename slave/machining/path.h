// SPDX-License-Identifier: Apache-2.0
// The way of the tool by distance travelled: extracted points made smooth, so that they can be
// differentiated.
#pragma once

#include <functional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "common/geometry/polyline.h"
#include "common/protocol/messages.h"

namespace telekerf::machining {

/// A point of the way and its derivatives by arc length, workpiece frame; `first` is the unit tangent.
struct PathPoint {
  Vec3 position_m = Vec3::Zero();
  Vec3 first = Vec3::UnitX();
  Vec3 second = Vec3::Zero();  ///< curvature vector, 1/m
  Vec3 third = Vec3::Zero();   ///< 1/m^2
};

/// One node of a curve with any parameter: position and derivatives by that parameter.
struct PathNode {
  double parameter = 0.0;
  Vec3 position_m = Vec3::Zero();
  Vec3 first = Vec3::Zero();
  Vec3 second = Vec3::Zero();
};

struct PathSettings {
  /// Corners are rounded until the way is this far from the points, and no further than `max_smoothing_m`.
  double tolerance_m = 15e-6;
  double min_smoothing_m = 12e-6;  ///< standard deviation of the Gaussian, along the arc
  double max_smoothing_m = 40e-6;
};

/// A curve in space, twice continuously differentiable by arc length: quintic Hermite pieces between nodes.
class Path {
 public:
  /// Closed contours: elliptic Fourier descriptors (eq. 8-9) whose harmonics are weighted by a Gaussian,
  /// which is the same as to mollify the contour along its arc: no ringing beside corners. Open ones: the
  /// same Gaussian on the points, then a C2 cubic spline (eq. 11-13); the ends stay where they are.
  static tl::expected<Path, std::string> through(const geometry::Polyline& line,
                                                 const PathSettings& settings);
  /// Through nodes whose parameter increases (a closed curve repeats its first node at the end).
  static tl::expected<Path, std::string> through(const std::vector<PathNode>& nodes, bool closed);

  double length_m() const noexcept { return nodes_.back().parameter; }
  bool closed() const noexcept { return closed_; }
  /// Beyond the ends an open way goes on straight, a closed one goes round again. Real-time: noexcept.
  PathPoint at(double arc_length_m) const noexcept;

  double smoothing_m() const noexcept { return smoothing_m_; }
  std::size_t harmonics() const noexcept { return harmonics_; }  ///< 0: a spline

 private:
  std::vector<PathNode> nodes_;  ///< by arc length
  bool closed_ = false;
  double smoothing_m_ = 0.0;
  std::size_t harmonics_ = 0;
};

/// Height of a curved workpiece over the plane, with slope and curvature.
struct Surface {
  double height_m = 0.0;
  Vec2 slope = Vec2::Zero();
  Eigen::Matrix2d curvature = Eigen::Matrix2d::Zero();  ///< second derivatives, 1/m
};
using SurfaceLaw = std::function<Surface(const Vec2& in_plane_m)>;

/// The flat way laid onto a surface along z (the beam's direction), by the new arc length.
tl::expected<Path, std::string> wrapped(const Path& flat, const SurfaceLaw& surface);

/// Standard deviation of the Gaussian that keeps every point within `tolerance_m` of where it was.
double smoothing_for(const geometry::Polyline& line, const PathSettings& settings);

}  // namespace telekerf::machining
