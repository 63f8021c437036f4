// SPDX-License-Identifier: Apache-2.0
// Where do the carriages of the slave's robot stand while its tool runs round a circle?
//
// You see a table: the tool's angle on the circle, the three joint positions in millimetres, the condition
// number of the Jacobian (1: all directions alike), and how far the forward kinematics are off the tool that
// the inverse began with: less than a picometre. A pose out of reach is an error value that says why.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "common/robot/robot_model.h"

int main() {
  using telekerf::Vec3;
  const auto model = telekerf::robot::load_robot("slave-keops");
  const telekerf::robot::DeltaKinematics kinematics(model.geometry);

  fmt::print("  angle   d1 mm    d2 mm    d3 mm    condition   forward - tool, m\n");
  double largest_m = 0.0;
  for (int degrees = 0; degrees < 360; degrees += 30) {
    const double angle = degrees * std::numbers::pi / 180.0;
    const Vec3 tool_in_workpiece_m(0.015 * std::cos(angle), 0.015 * std::sin(angle), 0.0);
    const Vec3 tool_m = model.in_base(tool_in_workpiece_m);
    const auto joints_m = kinematics.inverse(tool_m);
    if (!joints_m) {
      fmt::print("  {:5}   {}\n", degrees, describe(joints_m.error()));
      continue;
    }
    const double error_m = (kinematics.forward(*joints_m).value() - tool_m).norm();
    largest_m = std::max(largest_m, error_m);
    const Vec3 mm = 1e3 * *joints_m;
    fmt::print("  {:5} {:7.3f}  {:7.3f}  {:7.3f}   {:9.3f}   {:.1e}\n", degrees, mm.x(), mm.y(), mm.z(),
               kinematics.conditioning(*joints_m, tool_m).condition, error_m);
  }
  const auto far = kinematics.inverse(model.in_base(Vec3(0.2, 0.0, 0.0)));
  fmt::print("200 mm aside: {}\n", far ? "reachable" : describe(far.error()));
  return largest_m < 1e-12 && !far ? 0 : 1;
}
