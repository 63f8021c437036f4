// SPDX-License-Identifier: Apache-2.0
#include "master/constraint.h"

#include <algorithm>
#include <cmath>

namespace telekerf::master {

Guide make_guide(const ContourMessage& contour, double beta, const ConstraintSettings& settings) {
  geometry::Polyline line;
  line.closed = contour.closed;
  for (const auto& point : contour.points_m) line.points_m.push_back(point / beta);
  return {contour.id, beta, geometry::NearestIndex(geometry::resampled(line, settings.spacing_m))};
}

ActiveConstraint ConstraintGenerator::at(const Guide& guide, const Vec2& tool_m) noexcept {
  ActiveConstraint active;
  active.nearest = last_segment_ ? guide.curve.find_near(tool_m, *last_segment_) : guide.curve.find(tool_m);
  last_segment_ = active.nearest.segment;
  const geometry::Polyline& line = guide.curve.line();
  const auto half = static_cast<std::size_t>(settings_.half_window);
  active.shape = geometry::fit_circle(geometry::window(line, active.nearest.vertex(line), half).view());
  // Along the tangent the true nearest point lies abreast of the tool, but for the ends of an open curve and
  // for corners that the tool has overshot.
  const double past = active.shape.tangent(tool_m).dot(tool_m - active.nearest.point_m);
  const bool at_end = !line.closed && (active.nearest.arc_length_m <= 0.0 ||
                                       active.nearest.arc_length_m >= guide.curve.length_m());
  if (at_end || std::abs(past) > settings_.corner_m) active.beyond_end_m = past;
  return active;
}

Vec3 constrained_acceleration(const ActiveConstraint& active, const ConstraintSettings& settings,
                              const Vec3& tool_m, const Vec3& velocity_m_per_s, const Vec3& hand_n) noexcept {
  const double k1 = settings.bandwidth_rad_s * settings.bandwidth_rad_s;
  const double k2 = 2.0 * settings.damping * settings.bandwidth_rad_s;
  const Vec2 x = tool_m.head<2>();
  const Vec2 v = velocity_m_per_s.head<2>();

  // Rows of J_phi: the unit gradient in plane, and z. Its right inverse is its transpose.
  const Vec2 across = active.shape.gradient(x);
  const double phi = active.shape.phi(x);
  const double bend = v.dot(active.shape.hessian(x) * v);  // J_phi' x'
  const double a_across = -bend - k2 * across.dot(v) - k1 * phi;

  const Vec2 along = active.shape.tangent(x);
  const double speed = along.dot(v);
  double pull = along.dot(hand_n.head<2>());
  pull -= std::clamp(pull, -settings.dead_force_n, settings.dead_force_n);
  const double past = active.beyond_end_m;
  if (pull * past > 0.0) pull = 0.0;  // what pushes further out meets a wall, what pulls back moves the pen
  double a_along = (pull - settings.drag_ns_per_m * speed) / settings.mass_kg;
  if (past != 0.0) {
    const double w = settings.end_bandwidth_rad_s;
    a_along -= w * w * past + (speed * past > 0.0 ? 2.0 * w * speed : 0.0);
  }

  Vec3 wanted;
  wanted.head<2>() = a_across * across + a_along * along;
  wanted.z() = -k2 * velocity_m_per_s.z() - k1 * tool_m.z();
  return wanted;
}

}  // namespace telekerf::master
