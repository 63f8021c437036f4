// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/contouring_control.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace telekerf::machining {
namespace {

/// A vector and its first two derivatives by arc length.
struct Jet {
  Vec3 value, first, second;
};

/// Of m = n u with |u| = 1: n' = u.m', u' = (m' - n' u) / n and once more.
Jet normalised(const Jet& m, double length) noexcept {
  Jet u;
  u.value = m.value / length;
  const double n1 = u.value.dot(m.first);
  u.first = (m.first - n1 * u.value) / length;
  const double n2 = u.first.dot(m.first) + u.value.dot(m.second);
  u.second = (m.second - n2 * u.value - 2.0 * n1 * u.first) / length;
  return u;
}

}  // namespace

MovingFrame moving_frame(const Reference& r) noexcept {
  const Jet t{r.tangent, r.tangent_s, r.tangent_ss};
  const auto left = [](const Vec3& v) { return Vec3(-v.y(), v.x(), 0.0); };  // z x v
  const Jet across{left(t.value), left(t.first), left(t.second)};
  const double length = across.value.norm();
  MovingFrame frame;
  if (!(length > 1e-6)) return frame;
  const Jet n = normalised(across, length);
  const Jet b{t.value.cross(n.value), t.first.cross(n.value) + t.value.cross(n.first),
              t.second.cross(n.value) + 2.0 * t.first.cross(n.first) + t.value.cross(n.second)};
  Mat3 by_arc, by_arc2;
  frame.rows << t.value.transpose(), n.value.transpose(), b.value.transpose();
  by_arc << t.first.transpose(), n.first.transpose(), b.first.transpose();
  by_arc2 << t.second.transpose(), n.second.transpose(), b.second.transpose();
  frame.rate = r.speed_m_per_s * by_arc;
  frame.rate2 = r.speed_m_per_s * r.speed_m_per_s * by_arc2 + r.speed_rate_m_per_s2 * by_arc;
  return frame;
}

Vec3 ContouringControl::update(const Tracking& now) const noexcept {
  const Reference reference = now.trajectory.at(now.tick);
  const Vec3 ahead = now.trajectory.at(now.tick + acceleration_ahead).acceleration_m_per_s2;
  MovingFrame frame = moving_frame(reference);
  // Errors that are turned along with a fast frame ask for centrifugal forces that come too late, round after
  // round and corner after corner; and what is along the path now is across it when the currents act.
  const double along = bandwidth_rad_s[0], across = bandwidth_rad_s[1];
  const double followed = std::clamp(2.0 - std::sqrt(frame.rate2.norm()) / along, 0.0, 1.0);
  frame.rate *= followed;
  frame.rate2 *= followed;
  const Vec3 bandwidth(across + followed * (along - across), across, bandwidth_rad_s[2]);
  const Mat3 k1 = bandwidth.cwiseAbs2().asDiagonal();
  const Mat3 k2 = (2.0 * damping.cwiseProduct(bandwidth)).asDiagonal();
  const Vec3 e = now.origin_in_base_m + reference.position_m - now.measured.tool_m;
  const Vec3 de = reference.velocity_m_per_s - now.measured.tool_velocity_m_per_s;
  const Vec3 desired =
      ahead + frame.rows.transpose() * ((2.0 * frame.rate + k2 * frame.rows) * de +
                                        (frame.rate2 + k2 * frame.rate + k1 * frame.rows) * e);
  return now.measured.joint_acceleration(desired);
}

}  // namespace telekerf::machining
