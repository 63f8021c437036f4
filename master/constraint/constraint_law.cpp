// SPDX-License-Identifier: Apache-2.0
#include "master/constraint/constraint_law.h"

#include <algorithm>
#include <cmath>

#include "common/control/tracking_law.h"
#include "master/constraint/virtual_wall.h"

namespace telekerf::master {
namespace {

double without(double force, double dead) noexcept { return force - std::clamp(force, -dead, dead); }

/// Eq. 65 with a bound on the speed of return: near the curve it is e'' = -K2 e' - K1 e. K1 and K2 are those
/// of eq. 66-67 for a held acceleration.
double decaying(const ConstraintSettings& settings, double e, double e_rate) noexcept {
  const auto [k1, k2] = control::sampled_gains(settings.bandwidth_rad_s, settings.damping, settings.period_s);
  return -k2 * (e_rate + std::clamp(k1 / k2 * e, -settings.return_m_per_s, settings.return_m_per_s));
}

double along_the_curve(const ActiveConstraint& active, const ConstraintSettings& settings, double pull_n,
                       double speed, bool hold_in_bends) noexcept {
  double a = (pull_n - settings.damping_n_s_per_m * speed) / settings.mass_kg;
  if (hold_in_bends) {
    // v' <= (limit - v) / tau on either way along the curve; the slope leads it into the bend.
    constexpr double kRate = 250.0;
    const double limit = active.limit.m_per_s;
    const double lead = active.limit.slope_per_s * speed;
    if (speed >= 0.0) {
      a = std::min(a, kRate * (limit - speed) + std::min(lead, 0.0));
    } else {
      a = std::max(a, kRate * (-limit - speed) - std::min(lead, 0.0));
    }
  }
  if (active.beyond_end_m != 0.0) {
    const double side = std::copysign(1.0, active.beyond_end_m);
    a = side * virtual_wall_acceleration(side * a, side * active.beyond_end_m, side * speed,
                                         settings.wall_skin_m, settings.end_bandwidth_rad_s);
  }
  return a;
}

}  // namespace

Vec3 guided_acceleration(const ActiveConstraint& active, const ConstraintSettings& settings,
                         const KinematicState& tool, const Vec3& hand_n, const ConstraintReference& reference,
                         double felt_n) noexcept {
  const Vec2 x = tool.position_m.head<2>();
  const Vec2 v = tool.velocity_m_per_s.head<2>();
  const geometry::CircleOrLine& shape = active.piece.shape;
  const Vec2 along = shape.tangent(x);
  const double bend = v.dot(shape.hessian(x) * v);  // J_phi' x'
  const double pull = without(along.dot(hand_n.head<2>()), settings.force_deadband_n) + felt_n;
  const double a_along = along_the_curve(active, settings, pull, along.dot(v), true);
  Vec3 wanted;
  wanted.head<2>() = (reference.acceleration_m_per_s2[0] - bend) * shape.gradient(x) + a_along * along;
  wanted.z() = reference.acceleration_m_per_s2[1];
  return wanted + guiding_correction(active, settings, tool, reference);
}

Vec3 guiding_correction(const ActiveConstraint& active, const ConstraintSettings& settings,
                        const KinematicState& tool, const ConstraintReference& reference) noexcept {
  // Rows of J_phi: the unit gradient in plane, and z. Its right inverse is its transpose.
  const Vec2 across = active.piece.shape.gradient(tool.position_m.head<2>());
  const double rate = across.dot(tool.velocity_m_per_s.head<2>()) + active.drift_m_per_s;
  Vec3 correction;
  correction.head<2>() =
      decaying(settings, active.phi_m - reference.place_m[0], rate - reference.velocity_m_per_s[0]) * across;
  correction.z() = decaying(settings, tool.position_m.z() - reference.place_m[1],
                            tool.velocity_m_per_s.z() - reference.velocity_m_per_s[1]);
  return correction;
}

Vec3 region_acceleration(const ActiveConstraint& active, const ConstraintSettings& settings,
                         const ConstraintMode& mode, const KinematicState& tool,
                         const Vec3& hand_n) noexcept {
  const Vec2 x = tool.position_m.head<2>();
  const Vec2 v = tool.velocity_m_per_s.head<2>();
  const Vec2 across = active.piece.shape.gradient(x);
  const Vec2 along = active.piece.shape.tangent(x);
  const double phi = active.phi_m;
  const double rate = across.dot(v) + active.drift_m_per_s;

  const double drag = settings.damping_n_s_per_m + 2.0 * std::sqrt(mode.stiffness_n_per_m * settings.mass_kg);
  const double push = without(across.dot(hand_n.head<2>()), settings.force_deadband_n);
  double a_across = (push - drag * across.dot(v) - mode.stiffness_n_per_m * phi) / settings.mass_kg;
  const double side = std::copysign(1.0, phi);
  a_across = side * virtual_wall_acceleration(side * a_across, side * phi - mode.corridor_m, side * rate,
                                              settings.wall_skin_m, settings.bandwidth_rad_s);
  const double pull = without(along.dot(hand_n.head<2>()), settings.force_deadband_n);
  const double a_along = along_the_curve(active, settings, pull, along.dot(v), false);
  Vec3 wanted;
  wanted.head<2>() = a_across * across + a_along * along;
  wanted.z() = decaying(settings, tool.position_m.z(), tool.velocity_m_per_s.z());
  return wanted;
}

}  // namespace telekerf::master
