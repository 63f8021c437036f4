// SPDX-License-Identifier: Apache-2.0
#include "master/constraint/reach.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "common/robot/workspace.h"
#include "common/runtime/startup_error.h"
#include "master/constraint/virtual_wall.h"

namespace telekerf::master {
namespace {

constexpr double kPlay_m = 0.5e-3;  // above and below the working plane

/// Why the tool may not be there; empty: it may.
std::string objection(const robot::RobotModel& model, const robot::DeltaKinematics& kinematics,
                      const Vec3& tool_m) {
  const Vec3 in_base = model.in_base(tool_m);
  const auto joints = kinematics.inverse(in_base);
  if (!joints) return robot::describe(joints.error());
  const auto& geometry = model.geometry;
  for (int leg = 0; leg < 3; ++leg) {
    const double low = geometry.stroke_min_m + kStrokeRoom_m;
    const double high = geometry.stroke_max_m - kStrokeRoom_m;
    const double at = (*joints)[leg];
    if (at < low || at > high) {
      return fmt::format("carriage {} would stand at {:.2f} mm, but it may go from {:.2f} to {:.2f} mm",
                         leg + 1, 1e3 * at, 1e3 * low, 1e3 * high);
    }
  }
  const double condition = kinematics.conditioning(*joints, in_base).condition;
  if (!(condition <= robot::kWorstCondition)) {
    return fmt::format("the condition number of the pose is {:.1f}, but it may be {:g} at most", condition,
                       robot::kWorstCondition);
  }
  return {};
}

double reach_of(std::span<const Vec2> points_m) {
  double reach_m = 0.0;
  for (const Vec2& point : points_m) reach_m = std::max(reach_m, point.norm());
  return reach_m;
}

void require_within(const robot::RobotModel& model, double reach_m, double beta) {
  if (reach_m <= model.workspace.radius_m) return;
  throw input_error(
      fmt::format("the contour reaches {:.1f} mm from the centre of the master's workspace at beta = {:g}, "
                  "but {} reaches {:.1f} mm; use a larger --beta or a smaller --width-mm",
                  reach_m * 1e3, beta, model.name, model.workspace.radius_m * 1e3));
}

}  // namespace

void require_room(const robot::RobotModel& model, std::span<const Vec2> points_m, double beta) {
  require_within(model, reach_of(points_m) / beta, beta);
}

void require_reach(const robot::RobotModel& model, const GuidePath& guide, double corridor_m) {
  const robot::DeltaKinematics kinematics(model.geometry);
  const auto require = [&](const std::string& what, const Vec2& at, double above_m) {
    const std::string why = objection(model, kinematics, Vec3(at.x(), at.y(), above_m));
    if (why.empty()) return;
    throw input_error(
        fmt::format("{} at ({:.2f}, {:.2f}) mm is no place for {} at beta = {:g}: {}; use a larger --beta, a "
                    "smaller --width-mm or another --anchor",
                    what, 1e3 * at.x(), 1e3 * at.y(), model.name, guide.beta, why));
  };
  const auto& line = guide.curve.line();
  require_within(model, reach_of(line.points_m), guide.beta);
  constexpr std::size_t kEvery = 8;  // points are 25 um apart
  for (std::size_t i = 0; i < line.size(); i += kEvery) {
    const Vec2& point = line.points_m[i];
    const Vec2& next = line.points_m[i + 1 < line.size() ? i + 1 : 0];
    const Vec2 along = (next - point).normalized();
    const Vec2 left(-along.y(), along.x());
    for (const double side : {0.0, -corridor_m, corridor_m}) {
      for (const double above : {0.0, -kPlay_m, kPlay_m})
        require(fmt::format("contour point {} of {}", i + 1, line.size()), point + side * left, above);
    }
  }
  const Vec2 goal = guide.curve.find(Vec2::Zero()).point_m;
  for (int i = 0; i <= 20; ++i) require("the way to the contour", i / 20.0 * goal, 0.0);
}

Vec3 within_strokes(const robot::DeltaGeometry& geometry, const Vec3& joints_m,
                    const Vec3& joint_velocity_m_per_s, const Vec3& wanted_m_per_s2) noexcept {
  constexpr double kSkin_m = 0.2e-3;
  constexpr double kWall_rad_s = 150.0;
  const double middle = 0.5 * (geometry.stroke_min_m + geometry.stroke_max_m);
  const double half = 0.5 * (geometry.stroke_max_m - geometry.stroke_min_m) - kStrokeRoom_m;
  Vec3 out = wanted_m_per_s2;
  for (int leg = 0; leg < 3; ++leg) {
    const double side = std::copysign(1.0, joints_m[leg] - middle);
    out[leg] = side * virtual_wall_acceleration(side * out[leg], side * (joints_m[leg] - middle) - half,
                                                side * joint_velocity_m_per_s[leg], kSkin_m, kWall_rad_s);
  }
  return out;
}

}  // namespace telekerf::master
