// SPDX-License-Identifier: Apache-2.0
// The motion constraint of thesis 3.3: a circle through the points around the tool, or a line where they are
// straight.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "common/geometry/polyline.h"

namespace telekerf::geometry {

/// Largest number of points to either side in a constraint window.
inline constexpr std::size_t kMaxHalfWindow = 32;

/// The points P[m-k] .. P[m+k] of eq. 15, in drawing order and without allocation.
struct Window {
  std::array<Vec2, 2 * kMaxHalfWindow + 1> points;
  std::size_t count = 0;

  std::span<const Vec2> view() const noexcept { return {points.data(), count}; }
};

/// Eq. 15 around vertex `m`: a closed line wraps, at the ends of an open one the window is shifted inwards so
/// that it keeps its size. `k` is bounded by kMaxHalfWindow and by the number of points.
Window window(const Polyline& line, std::size_t m, std::size_t k) noexcept;

/// A circle or a line with a direction of travel. `phi` is the signed distance to it in metres, positive to
/// the left of travel: eq. 165's first constraint with a gradient of unit norm, so that circle and line mean
/// the same to a controller and nothing flips its sign from one fit to the next.
struct CircleOrLine {
  bool is_line = true;
  Vec2 centre_m = Vec2::Zero();    ///< circle only
  double radius_m = 0.0;           ///< circle only
  bool anticlockwise = true;       ///< circle only: travel leaves the centre on its left
  Vec2 point_m = Vec2::Zero();     ///< a point on it: the window's mean, projected
  Vec2 direction = Vec2::UnitX();  ///< unit tangent at point_m, in drawing order
  double residual_m = 0.0;         ///< rms distance of the points from it

  double phi(const Vec2& x) const noexcept;
  /// d phi / dx, a unit vector; at the centre of a circle, where it does not exist, the normal at point_m.
  Vec2 gradient(const Vec2& x) const noexcept;
  /// d(gradient)/dx, symmetric: J' = hessian * velocity.
  Eigen::Matrix2d hessian(const Vec2& x) const noexcept;
  /// Unit tangent of travel at x: the gradient turned clockwise.
  Vec2 tangent(const Vec2& x) const noexcept;
  /// Foot point of x.
  Vec2 project(const Vec2& x) const noexcept;
  /// Signed curvature in 1/m, positive for a left turn, 0 for a line.
  double curvature() const noexcept;
};

/// Least squares after Taubin instead of eq. 18-19: those shrink short noisy arcs (11 points of a 30 degree
/// arc of r = 2, sigma 0.01: mean r 1.80) and lose their rank on a straight one. Points in drawing order;
/// duplicates are harmless. A line is returned when the arc bends by less than 1e-7 of its extent or there
/// are fewer than three points.
CircleOrLine fit_circle(std::span<const Vec2> points) noexcept;
/// The same where point i counts `weights[i]` >= 0 times; as many weights as points.
CircleOrLine fit_circle(std::span<const Vec2> points, std::span<const double> weights) noexcept;

/// The circle that has point, unit tangent and signed curvature (1/m) in common with a curve; below 1e-3 a
/// line.
CircleOrLine osculating(const Vec2& point, const Vec2& tangent, double curvature) noexcept;

}  // namespace telekerf::geometry
