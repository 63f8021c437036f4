// SPDX-License-Identifier: Apache-2.0
// How does the virtual constraint hold a hand on a circle?
//
// A point of one kilogram is the tool. A hand pushes it along a circle of 20 mm radius and, ten times a
// second, from one side to the other with 3 N. The constraint turns that into an acceleration: free along the
// curve, stiff across it. You see the tool run round while its distance from the circle stays below a tenth
// of a micrometre: here nothing disturbs the tool but the hand, and the hand is known.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "master/constraint/constraint_controller.h"

int main() {
  using namespace telekerf;
  using std::numbers::pi;
  ContourMessage contour;
  contour.id = 1;
  for (int i = 0; i < 720; ++i)
    contour.points_m.emplace_back(0.02 * std::cos(i * pi / 360), 0.02 * std::sin(i * pi / 360));

  const master::ConstraintSettings settings;
  const master::GuidePath guide = master::make_guide(contour, /*beta=*/1.0, settings);
  master::ConstraintController constraint(settings);
  constraint.enter();

  control::KinematicState tool;
  tool.position_m = Vec3(0.02, 0.0, 0.0);
  double farthest_m = 0.0;
  double way_m = 0.0;
  for (int tick = 0; tick < 4000; ++tick) {
    const double t_s = tick * settings.period_s;
    const Vec2 outwards = tool.position_m.head<2>().normalized();
    const Vec2 push_n =
        0.5 * Vec2(-outwards.y(), outwards.x()) + 3.0 * std::sin(2 * pi * 10 * t_s) * outwards;
    const Vec3 hand_n(push_n.x(), push_n.y(), 0.0);
    const Vec3 acceleration = constraint.step(guide, tool, hand_n, settings.period_s);
    tool.position_m += settings.period_s * tool.velocity_m_per_s +
                       0.5 * settings.period_s * settings.period_s * acceleration;
    tool.velocity_m_per_s += settings.period_s * acceleration;
    way_m += settings.period_s * tool.velocity_m_per_s.norm();
    const double off_m = std::abs(tool.position_m.head<2>().norm() - 0.02);
    farthest_m = std::max(farthest_m, off_m);
    if (tick % 500 == 0)
      fmt::print("{:4.1f} s  at ({:6.2f}, {:6.2f}) mm  {:5.1f} mm/s  off the curve {:.3f} um\n", t_s,
                 1e3 * tool.position_m.x(), 1e3 * tool.position_m.y(), 1e3 * tool.velocity_m_per_s.norm(),
                 1e6 * off_m);
  }
  fmt::print("{:.0f} mm travelled, never more than {:.3f} um off the curve\n", 1e3 * way_m, 1e6 * farthest_m);
  return way_m > 0.1 && farthest_m < 1e-6 ? 0 : 1;
}
