// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/beam_monitor.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace telekerf::laser {
namespace {

using Triple = std::array<float, 3>;

Triple minus(const Triple& a, const Triple& b) noexcept { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Triple along(const Triple& a, float t, const Triple& d) noexcept {
  return {a[0] + t * d[0], a[1] + t * d[1], a[2] + t * d[2]};
}
float dot(const Triple& a, const Triple& b) noexcept { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Triple cross(const Triple& a, const Triple& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

CorridorRaster::CorridorRaster(std::span<const geometry::Polyline> lines, double half_m, double radius_m)
    : origin_m_(static_cast<float>(-radius_m - 2.0 * half_m)),
      side_(static_cast<int>(std::ceil(-2.0F * origin_m_ / kCell_m))),
      cells_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), 0) {
  for (const geometry::Polyline& line : lines) draw(line, half_m);
}

void CorridorRaster::draw(const geometry::Polyline& line, double half_m) {
  const auto& points_m = line.points_m;
  for (std::size_t n = 0; n + 1 < points_m.size(); ++n) draw(points_m[n], points_m[n + 1], half_m);
  if (points_m.size() == 1 || (line.closed && !points_m.empty()))
    draw(points_m.back(), points_m.front(), half_m);
}

void CorridorRaster::draw(const Vec2& from_m, const Vec2& to_m, double half_m) {
  const auto cell = [&](double at_m) {
    return std::clamp(static_cast<int>(std::floor((at_m - origin_m_) / kCell_m)), 0, side_ - 1);
  };
  const Vec2 way = to_m - from_m;
  const double length2 = way.squaredNorm();
  for (int y = cell(std::min(from_m.y(), to_m.y()) - half_m);
       y <= cell(std::max(from_m.y(), to_m.y()) + half_m); ++y) {
    for (int x = cell(std::min(from_m.x(), to_m.x()) - half_m);
         x <= cell(std::max(from_m.x(), to_m.x()) + half_m); ++x) {
      const Vec2 middle(origin_m_ + (x + 0.5) * kCell_m, origin_m_ + (y + 0.5) * kCell_m);
      const double t = length2 > 0.0 ? std::clamp(way.dot(middle - from_m) / length2, 0.0, 1.0) : 0.0;
      if ((from_m + t * way - middle).norm() > half_m) continue;
      cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(x)] = 1;
    }
  }
}

bool CorridorRaster::holds(float x_m, float y_m) const noexcept {
  const float x = (x_m - origin_m_) / kCell_m;
  const float y = (y_m - origin_m_) / kCell_m;
  const auto side = static_cast<float>(side_);
  if (!(x >= 0.0F && y >= 0.0F && x < side && y < side)) return false;
  return cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) +
                static_cast<std::size_t>(x)] != 0;
}

SingleKinematics::SingleKinematics(const robot::RobotModel& model) noexcept
    : side_(model.geometry.assembly_mode == robot::AssemblyMode::kAbove ? 1.0F : -1.0F) {
  const robot::DeltaGeometry& g = model.geometry;
  for (std::size_t n = 0; n < 3; ++n) {
    const auto turn = static_cast<float>(g.rail_angle_rad[n]);
    const auto attack = static_cast<float>(g.attack_angle_rad[n]);
    const auto reach = static_cast<float>(g.base_radius_m - g.tool_radius_m);
    legs_[n] = {{reach * std::cos(turn), reach * std::sin(turn), 0.0F},
                {-std::cos(attack) * std::cos(turn), -std::cos(attack) * std::sin(turn), std::sin(attack)},
                static_cast<float>(g.rod_length_m[n])};
    centre_m_[n] = static_cast<float>(model.workspace.centre_m[static_cast<int>(n)]);
  }
}

Triple SingleKinematics::tool_m(const Triple& joints_m) const noexcept {
  std::array<Triple, 3> s;
  for (std::size_t n = 0; n < 3; ++n) s[n] = along(legs_[n].origin_m, joints_m[n], legs_[n].rail);
  // Three spheres about s[0]: two planes, whose line meets the first sphere twice.
  const Triple u = minus(s[1], s[0]);
  const Triple v = minus(s[2], s[0]);
  const float l0 = legs_[0].rod_m;
  const float a = 0.5F * (dot(u, u) + l0 * l0 - legs_[1].rod_m * legs_[1].rod_m);
  const float b = 0.5F * (dot(v, v) + l0 * l0 - legs_[2].rod_m * legs_[2].rod_m);
  const Triple normal = cross(u, v);
  const float area2 = dot(normal, normal);
  const Triple u_part = cross(v, normal);
  const Triple v_part = cross(normal, u);
  const Triple foot = {(a * u_part[0] + b * v_part[0]) / area2, (a * u_part[1] + b * v_part[1]) / area2,
                       (a * u_part[2] + b * v_part[2]) / area2};
  const float height2 = (l0 * l0 - dot(foot, foot)) / area2;
  if (!(height2 >= 0.0F)) {
    const float none = std::numeric_limits<float>::quiet_NaN();
    return {none, none, none};
  }
  const float up = normal[2] >= 0.0F ? side_ : -side_;
  const Triple from_first = along(foot, up * std::sqrt(height2), normal);
  return minus(along(s[0], 1.0F, from_first), centre_m_);
}

void BeamMonitor::step(const robot::JointReading& reading, const CorridorRaster* corridor, bool stopped,
                       bool lit) noexcept {
  if (!agrees()) return;
  bool good = reading.valid && corridor != nullptr && !stopped;
  if (good && lit) {
    const Triple tool_m =
        kinematics_.tool_m({static_cast<float>(reading.joints_m[0]), static_cast<float>(reading.joints_m[1]),
                            static_cast<float>(reading.joints_m[2])});
    good = corridor->holds(tool_m[0], tool_m[1]) && std::abs(tool_m[2]) <= max_height_m_;
  }
  against_ = lit && !good ? against_ + 1 : 0;
}

}  // namespace telekerf::laser
