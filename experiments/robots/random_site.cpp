// SPDX-License-Identifier: Apache-2.0
#include "experiments/robots/random_site.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "common/robot/robot_model.h"
#include "common/runtime/resources.h"
#include "common/runtime/results.h"
#include "experiments/draw.h"
#include "netem/core/profile.h"

namespace telekerf::experiments {
namespace {

using Kind = master::OperatorDisturbance::Kind;

/// Of a hand, whatever the motors can hold.
constexpr double kStrongest_n = 30.0;

void scale_lengths(robot::DeltaGeometry& geometry, double scale, Draw& draw) {
  for (double* length :
       {&geometry.base_radius_m, &geometry.tool_radius_m, &geometry.stroke_min_m, &geometry.stroke_max_m})
    *length *= scale;
  for (double& rod : geometry.rod_length_m) rod *= scale * draw.between(0.98, 1.02);
}

robot::RobotModel random_robot(Draw& draw) {
  constexpr std::array kShipped{"master-horizontal", "slave-keops", "vertical", "asymmetric"};
  robot::RobotModel robot = robot::load_robot(draw.one_of(kShipped), false);
  scale_lengths(robot.geometry, draw.factor(0.8, 1.25), draw);
  const double force = draw.factor(0.7, 1.5);
  robot.motor.continuous_force_n *= force;
  robot.motor.peak_force_n *= force;
  robot.motor.mass_kg *= draw.factor(0.5, 2.0);
  robot.tool_mass_kg *= draw.factor(0.5, 2.0);
  const double friction = draw.factor(0.3, 3.0);
  robot.friction.coulomb_n *= friction;
  robot.friction.breakaway_n *= friction;
  robot.friction.viscous_n_s_per_m *= draw.factor(0.3, 3.0);
  robot.sensor.kind = robot::Sensor::Kind::kEncoder;
  robot.sensor.resolution_m = draw.factor(0.1e-6, 2e-6);
  if (draw.one_in(3)) robot.drive_delay_s = draw.between(0.0, 1.5e-3);
  return robot;
}

std::string text_of(const robot::RobotModel& robot) {
  const auto degrees = [](double rad) { return rad * 180.0 / std::numbers::pi; };
  const auto three = [](const auto& v, const auto& f) {
    return fmt::format("[{}, {}, {}]", f(v[0]), f(v[1]), f(v[2]));
  };
  const auto same = [](double value) { return value; };
  const robot::DeltaGeometry& g = robot.geometry;
  std::string text = fmt::format("drive_delay_s = {}\n\n[geometry]\n", robot.drive_delay_s);
  text += fmt::format("base_radius_m = {}\ntool_radius_m = {}\nrod_length_m = {}\n", g.base_radius_m,
                      g.tool_radius_m, three(g.rod_length_m, same));
  text += fmt::format("rail_angle_deg = {}\nattack_angle_deg = {}\n", three(g.rail_angle_rad, degrees),
                      three(g.attack_angle_rad, degrees));
  text += fmt::format("assembly_mode = \"{}\"\nworking_mode = [{}, {}, {}]\nstroke_m = [{}, {}]\n",
                      g.assembly_mode == robot::AssemblyMode::kAbove ? "above" : "below", g.working_mode[0],
                      g.working_mode[1], g.working_mode[2], g.stroke_min_m, g.stroke_max_m);
  const robot::Motor& m = robot.motor;
  text += fmt::format(
      "\n[motor]\nmass_kg = {}\nforce_constant_n_per_a = {}\ncontinuous_force_n = {}\npeak_force_n = {}\n",
      m.mass_kg, m.force_constant_n_per_a, m.continuous_force_n, m.peak_force_n);
  text += fmt::format("\n[tool]\nmass_kg = {}\n\n[sensor]\nkind = \"encoder\"\nresolution_m = {}\n",
                      robot.tool_mass_kg, robot.sensor.resolution_m);
  const robot::Friction& f = robot.friction;
  text += fmt::format("\n[friction]\ncoulomb_n = {}\nbreakaway_n = {}\nviscous_n_s_per_m = {}\n", f.coulomb_n,
                      f.breakaway_n, f.viscous_n_s_per_m);
  text += fmt::format("\n[limits]\nvelocity_m_per_s = {}\nacceleration_m_per_s2 = {}\n",
                      robot.limits.velocity_m_per_s, robot.limits.acceleration_m_per_s2);
  text += fmt::format("\n[mounting]\ngravity_m_per_s2 = {}\n", three(robot.gravity_m_per_s2, same));
  return text;
}

std::string write_robot(const robot::RobotModel& robot, const std::filesystem::path& file) {
  write_atomically(file, text_of(robot));
  return file.string();
}

std::vector<master::OperatorDisturbance> random_disturbances(Draw& draw, double duration_s, double force_n) {
  std::vector<master::OperatorDisturbance> all;
  for (int i = 0; i < 3; ++i) {
    if (!draw.one_in(2)) continue;
    const Kind kind = draw.one_of(std::array{Kind::kPush, Kind::kSlip, Kind::kLetGo, Kind::kFight});
    all.push_back({kind, draw.between(0.5, duration_s), draw.between(0.05, 0.5),
                   draw.between(-force_n, force_n), draw.between(-10.0, 10.0), draw.between(-5.0, 5.0)});
  }
  return all;
}

}  // namespace

RandomSite random_site(std::uint64_t seed, double duration_s, const std::filesystem::path& folder) {
  Draw draw(seed);
  RandomSite site;
  simulation::SimulationSettings& s = site.settings;
  s.seed = seed;
  s.duration_s = duration_s;
  s.image = draw.one_of(shipped_names("pictures", ".png"));
  const std::string profile = draw.one_of(shipped_names("profiles", ".toml"));
  s.network = netem::load_profile(profile);
  s.master.beta = draw.factor(0.2, 2.0);
  const robot::RobotModel master = random_robot(draw);
  s.master.robot = write_robot(master, folder / fmt::format("{}-master.toml", seed));
  s.slave.robot = write_robot(random_robot(draw), folder / fmt::format("{}-slave.toml", seed));
  s.master.mismatch = draw.between(0.0, 0.3);
  s.slave.node.interlock.beam_age_s = 2.0;  // slow networks, too, are to cut
  s.slave.mismatch = draw.between(0.0, 0.3);
  s.master.hand_speed_mm_s = draw.factor(5.0, 40.0);
  const double strongest_n = draw.one_in(3) ? kStrongest_n : 0.5 * master.motor.peak_force_n;
  s.master.hand.max_sideways_n = draw.between(0.0, std::min(strongest_n, kStrongest_n));
  s.master.hand.wander_n = draw.between(0.0, 10.0);
  s.master.hand.disturbances = random_disturbances(draw, duration_s, std::min(strongest_n, kStrongest_n));
  site.drawn = {{"image", s.image},
                {"profile", profile},
                {"beta", s.master.beta},
                {"master_mismatch", s.master.mismatch},
                {"slave_mismatch", s.slave.mismatch},
                {"hand_speed_mm_s", s.master.hand_speed_mm_s},
                {"hand_sideways_n", s.master.hand.max_sideways_n},
                {"disturbances", s.master.hand.disturbances.size()}};
  return site;
}

}  // namespace telekerf::experiments
