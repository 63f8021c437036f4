// SPDX-License-Identifier: Apache-2.0
// The machines that the robot tests sweep over, with wide strokes: every reachable pose counts.
#pragma once

#include <numbers>
#include <random>
#include <vector>

#include "common/robot/delta_kinematics.h"

namespace telekerf::robot::testing {

inline constexpr double kDeg = std::numbers::pi / 180;

struct Machine {
  const char* name;
  DeltaGeometry geometry;
};

inline DeltaGeometry machine(double base, double tool, std::array<double, 3> rods,
                             std::array<double, 3> theta_deg, std::array<double, 3> alpha_deg) {
  DeltaGeometry g;
  g.base_radius_m = base;
  g.tool_radius_m = tool;
  g.rod_length_m = rods;
  for (std::size_t i = 0; i < 3; ++i) {
    g.rail_angle_rad[i] = theta_deg[i] * kDeg;
    g.attack_angle_rad[i] = alpha_deg[i] * kDeg;
  }
  return g;
}

inline DeltaGeometry horizontal() { return machine(.12, .03, {.15, .15, .15}, {90, 210, 330}, {0, 0, 0}); }
inline DeltaGeometry keops() { return machine(.08, .025, {.09, .09, .09}, {90, 210, 330}, {30, 30, 30}); }
inline DeltaGeometry vertical() { return machine(.14, .04, {.25, .25, .25}, {90, 210, 330}, {90, 90, 90}); }
inline DeltaGeometry asymmetric() {
  return machine(.08, .025, {.09, .095, .10}, {90, 190, 350}, {20, 30, 40});
}
/// Carriages above, tool below, as in most printers.
inline DeltaGeometry printer() {
  DeltaGeometry g = vertical();
  g.assembly_mode = AssemblyMode::kBelow;
  g.working_mode = {-1, -1, -1};
  return g;
}
/// LinuxCNC's default: rod 269 mm, effective radius 130.25 mm, towers at 90/210/330 degrees.
inline DeltaGeometry linuxcnc(double rod, double radius, std::array<double, 3> towers_deg) {
  DeltaGeometry g = machine(radius, 0, {rod, rod, rod}, towers_deg, {90, 90, 90});
  g.assembly_mode = AssemblyMode::kBelow;
  g.working_mode = {-1, -1, -1};
  return g;
}

inline std::vector<Machine> machines() {
  return {{"horizontal", horizontal()},
          {"keops", keops()},
          {"vertical", vertical()},
          {"asymmetric", asymmetric()},
          {"printer", printer()}};
}

inline Vec3 random_in_box(std::mt19937_64& random, const Vec3& centre, double half_side) {
  std::uniform_real_distribution<double> unit(-half_side, half_side);
  return centre + Vec3(unit(random), unit(random), unit(random));
}

}  // namespace telekerf::robot::testing
