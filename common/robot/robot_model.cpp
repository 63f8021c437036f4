// SPDX-License-Identifier: Apache-2.0
#include "common/robot/robot_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <random>

#include "common/runtime/config.h"
#include "common/runtime/resources.h"
#include "common/runtime/startup_error.h"

namespace telekerf::robot {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;

std::array<double, 3> three(const ConfigFile& file, const std::string& key, Bounds bounds,
                            double factor = 1) {
  const auto values = file.numbers(key, 3, bounds);
  return {values[0] * factor, values[1] * factor, values[2] * factor};
}

DeltaGeometry read_geometry(const ConfigFile& file) {
  DeltaGeometry g;
  g.base_radius_m = file.number("geometry.base_radius_m", {.min = 0, .max = 10});
  g.tool_radius_m = file.number("geometry.tool_radius_m", {.min = 0, .max = 10});
  g.rod_length_m = three(file, "geometry.rod_length_m", {.min = 1e-3, .max = 10});
  g.rail_angle_rad = three(file, "geometry.rail_angle_deg", {.min = -360, .max = 360}, kRadPerDeg);
  g.attack_angle_rad = three(file, "geometry.attack_angle_deg", {.min = -180, .max = 180}, kRadPerDeg);
  (void)file.text("geometry.assembly_mode");
  g.assembly_mode = file.choice_or("geometry.assembly_mode", "above", {"above", "below"}) == "above"
                        ? AssemblyMode::kAbove
                        : AssemblyMode::kBelow;
  const auto stroke = file.numbers("geometry.stroke_m", 2, {.min = -10, .max = 10});
  g.stroke_min_m = stroke[0];
  g.stroke_max_m = stroke[1];
  if (g.stroke_min_m >= g.stroke_max_m)
    file.refuse("geometry.stroke_m", "must be [min, max] with min below max");
  if (file.has("geometry.working_mode")) {
    const auto modes = file.numbers("geometry.working_mode", 3, {.min = -1, .max = 1});
    for (std::size_t i = 0; i < 3; ++i) {
      if (modes[i] != 1 && modes[i] != -1)
        file.refuse("geometry.working_mode", "must hold 1 or -1 for each leg");
      g.working_mode[i] = static_cast<int>(modes[i]);
    }
  }
  return g;
}

Motor read_motor(const ConfigFile& file) {
  Motor m;
  m.mass_kg = file.number_or("motor.mass_kg", m.mass_kg, {.min = 1e-4, .max = 1000});
  m.force_constant_n_per_a =
      file.number_or("motor.force_constant_n_per_a", m.force_constant_n_per_a, {.min = 1e-3, .max = 1e4});
  m.continuous_force_n =
      file.number_or("motor.continuous_force_n", m.continuous_force_n, {.min = 1e-3, .max = 1e5});
  m.peak_force_n = file.number_or("motor.peak_force_n", std::max(m.peak_force_n, m.continuous_force_n),
                                  {.min = m.continuous_force_n, .max = 1e5});
  return m;
}

Sensor read_sensor(const ConfigFile& file) {
  Sensor s;
  s.kind = file.choice_or("sensor.kind", s.kind, kSensorKinds);
  s.resolution_m = file.number_or("sensor.resolution_m", s.resolution_m, {.min = 0, .max = 1e-3});
  s.pitch_m = file.number_or("sensor.pitch_m", s.pitch_m, {.min = 1e-4, .max = 1});
  s.adc_bits = static_cast<int>(file.integer_or("sensor.adc_bits", s.adc_bits, {.min = 4, .max = 24}));
  s.noise = file.number_or("sensor.noise", s.noise, {.min = 0, .max = 0.1});
  s.conversions =
      static_cast<int>(file.integer_or("sensor.conversions", s.conversions, {.min = 1, .max = 256}));
  s.conversion_s = file.number_or("sensor.conversion_s", s.conversion_s, {.min = 0, .max = 1e-3});
  constexpr double kLongest_s = 1e-3;  // a reading is of one moment
  if (s.conversions * s.conversion_s > kLongest_s)
    file.refuse("sensor.conversions",
                "times conversion_s takes longer than 1 ms; take fewer, or faster ones");
  s.gain_mismatch = file.number_or("sensor.gain_mismatch", s.gain_mismatch, {.min = 0, .max = 0.1});
  s.offset_mismatch = file.number_or("sensor.offset_mismatch", s.offset_mismatch, {.min = 0, .max = 0.1});
  s.phase_mismatch_rad =
      file.number_or("sensor.phase_mismatch_rad", s.phase_mismatch_rad, {.min = 0, .max = 0.2});
  s.calibrated = file.boolean_or("sensor.calibrated", s.calibrated);
  return s;
}

Friction read_friction(const ConfigFile& file) {
  Friction f;
  f.coulomb_n = file.number_or("friction.coulomb_n", f.coulomb_n, {.min = 0, .max = 1e4});
  f.breakaway_n = file.number_or("friction.breakaway_n", f.coulomb_n, {.min = f.coulomb_n, .max = 1e4});
  f.viscous_n_s_per_m =
      file.number_or("friction.viscous_n_s_per_m", f.viscous_n_s_per_m, {.min = 0, .max = 1e5});
  f.stribeck_velocity_m_per_s = file.number_or("friction.stribeck_velocity_m_per_s",
                                               f.stribeck_velocity_m_per_s, {.min = 1e-4, .max = 1});
  f.smoothing_velocity_m_per_s = file.number_or("friction.smoothing_velocity_m_per_s",
                                                f.smoothing_velocity_m_per_s, {.min = 1e-4, .max = 1});
  return f;
}

Workspace read_workspace(const ConfigFile& file, const DeltaKinematics& kinematics, bool needed) {
  if (!file.has("workspace")) {
    if (!needed) return {};
    Workspace computed = largest_cylinder(kinematics);
    if (computed.radius_m <= 0) {
      file.refuse(
          "geometry",
          "leaves no workspace: the rods reach no common place within the stroke; look at rod_length_m and "
          "stroke_m, and whether working_mode fits assembly_mode");
    }
    return computed;
  }
  Workspace w;
  const auto centre = file.numbers("workspace.centre_m", 3, {.min = -10, .max = 10});
  w.centre_m = Vec3(centre[0], centre[1], centre[2]);
  w.radius_m = file.number("workspace.radius_m", {.min = 1e-4, .max = 10});
  w.height_m = file.number("workspace.height_m", {.min = 0, .max = 10});
  if (needed && !(worst_condition(kinematics, w) < 1e6))
    file.refuse("workspace.radius_m", "the robot cannot reach all of it");
  return w;
}

RobotModel read(const ConfigFile& file, const std::string& name, bool with_workspace = true) {
  RobotModel robot;
  robot.name = file.text_or("name", name);
  robot.geometry = read_geometry(file);
  robot.motor = read_motor(file);
  robot.drive_delay_s = file.number_or("drive_delay_s", 0.0, {.min = 0, .max = 0.02});
  robot.tool_mass_kg = file.number_or("tool.mass_kg", robot.tool_mass_kg, {.min = 0, .max = 1000});
  robot.sensor = read_sensor(file);
  robot.friction = read_friction(file);
  robot.limits.velocity_m_per_s =
      file.number_or("limits.velocity_m_per_s", robot.limits.velocity_m_per_s, {.min = 1e-4, .max = 100});
  robot.limits.acceleration_m_per_s2 = file.number_or(
      "limits.acceleration_m_per_s2", robot.limits.acceleration_m_per_s2, {.min = 1e-3, .max = 1e4});
  if (file.has("mounting.gravity_m_per_s2")) {
    const auto gravity = file.numbers("mounting.gravity_m_per_s2", 3, {.min = -20, .max = 20});
    robot.gravity_m_per_s2 = Vec3(gravity[0], gravity[1], gravity[2]);
  }
  robot.workspace = read_workspace(file, DeltaKinematics(robot.geometry), with_workspace);
  file.refuse_unknown();
  return robot;
}

}  // namespace

RobotModel load_robot(const std::string& name_or_path, bool with_workspace) {
  const auto path = find_resource("robots", name_or_path, ".toml");
  return read(ConfigFile(path), path.stem().string(), with_workspace);
}

RobotModel parse_robot(const std::string& toml, const std::string& name) {
  return read(ConfigFile(toml, name), name);
}

RobotModel mismatched(const RobotModel& nominal, double share, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  // Not std::uniform_real_distribution: its sequence is not the same in every library.
  const auto off = [&] { return 1 + share * (2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1); };
  RobotModel real = nominal;
  real.motor.mass_kg *= off();
  real.motor.force_constant_n_per_a *= off();
  real.tool_mass_kg *= off();
  const double friction = off();
  real.friction.coulomb_n *= friction;
  real.friction.breakaway_n *= friction;
  real.friction.viscous_n_s_per_m *= off();
  return real;
}

}  // namespace telekerf::robot
