// SPDX-License-Identifier: Apache-2.0
// A robot's file: every key goes to its own place, and stands within its bounds.
#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "common/robot/robot_model.h"
#include "common/runtime/startup_error.h"

namespace telekerf::robot {
namespace {

const std::string kEveryKey = R"(name = "mine"
drive_delay_s = 0.0015
[geometry]
base_radius_m = 0.081
tool_radius_m = 0.022
rod_length_m = [0.09, 0.091, 0.092]
rail_angle_deg = [90, 211, 329]
attack_angle_deg = [30, 31, 32]
assembly_mode = "above"
stroke_m = [-0.001, 0.041]
working_mode = [1, 1, 1]
[motor]
mass_kg = 0.07
force_constant_n_per_a = 6.5
continuous_force_n = 3.25
peak_force_n = 11.5
[tool]
mass_kg = 0.0625
[sensor]
kind = "hall"
resolution_m = 0.25e-6
pitch_m = 0.019
adc_bits = 14
noise = 0.001
conversions = 32
conversion_s = 2e-6
gain_mismatch = 0.002
offset_mismatch = 0.003
phase_mismatch_rad = 0.004
calibrated = false
[friction]
coulomb_n = 0.125
breakaway_n = 0.25
viscous_n_s_per_m = 0.375
stribeck_velocity_m_per_s = 0.006
smoothing_velocity_m_per_s = 0.0007
[limits]
velocity_m_per_s = 0.35
acceleration_m_per_s2 = 21
[mounting]
gravity_m_per_s2 = [1, -2, 3]
[workspace]
centre_m = [0.001, -0.002, 0.09]
radius_m = 0.012
height_m = 0.004
)";

std::string with(const std::string& from, const std::string& to) {
  std::string text = kEveryKey;
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string refusal_of(const std::string& toml) {
  try {
    (void)parse_robot(toml, "f.toml");
  } catch (const StartupError& refusal) {
    return refusal.what();
  }
  return "";
}

TEST(RobotFile, EveryKeyGoesToItsOwnPlace) {
  const RobotModel robot = parse_robot(kEveryKey, "f.toml");
  constexpr double kDeg = std::numbers::pi / 180;
  EXPECT_EQ(robot.name, "mine");
  EXPECT_EQ(robot.geometry.base_radius_m, 0.081);
  EXPECT_EQ(robot.geometry.tool_radius_m, 0.022);
  EXPECT_EQ(robot.geometry.rod_length_m, (std::array<double, 3>{0.09, 0.091, 0.092}));
  EXPECT_EQ(robot.geometry.rail_angle_rad, (std::array<double, 3>{90 * kDeg, 211 * kDeg, 329 * kDeg}));
  EXPECT_EQ(robot.geometry.attack_angle_rad, (std::array<double, 3>{30 * kDeg, 31 * kDeg, 32 * kDeg}));
  EXPECT_EQ(robot.geometry.assembly_mode, AssemblyMode::kAbove);
  EXPECT_EQ(robot.geometry.stroke_min_m, -0.001);
  EXPECT_EQ(robot.geometry.stroke_max_m, 0.041);
  EXPECT_EQ(robot.motor.mass_kg, 0.07);
  EXPECT_EQ(robot.motor.force_constant_n_per_a, 6.5);
  EXPECT_EQ(robot.motor.continuous_force_n, 3.25);
  EXPECT_EQ(robot.motor.peak_force_n, 11.5);
  EXPECT_EQ(robot.tool_mass_kg, 0.0625);
  EXPECT_EQ(robot.sensor.kind, Sensor::Kind::kHall);
  EXPECT_EQ(robot.sensor.resolution_m, 0.25e-6);
  EXPECT_EQ(robot.sensor.pitch_m, 0.019);
  EXPECT_EQ(robot.sensor.adc_bits, 14);
  EXPECT_EQ(robot.sensor.noise, 0.001);
  EXPECT_EQ(robot.sensor.conversions, 32);
  EXPECT_EQ(robot.sensor.conversion_s, 2e-6);
  EXPECT_EQ(robot.sensor.gain_mismatch, 0.002);
  EXPECT_EQ(robot.sensor.offset_mismatch, 0.003);
  EXPECT_EQ(robot.sensor.phase_mismatch_rad, 0.004);
  EXPECT_FALSE(robot.sensor.calibrated);
  EXPECT_EQ(robot.friction.coulomb_n, 0.125);
  EXPECT_EQ(robot.friction.breakaway_n, 0.25);
  EXPECT_EQ(robot.friction.viscous_n_s_per_m, 0.375);
  EXPECT_EQ(robot.friction.stribeck_velocity_m_per_s, 0.006);
  EXPECT_EQ(robot.friction.smoothing_velocity_m_per_s, 0.0007);
  EXPECT_EQ(robot.limits.velocity_m_per_s, 0.35);
  EXPECT_EQ(robot.limits.acceleration_m_per_s2, 21);
  EXPECT_EQ(robot.gravity_m_per_s2, Vec3(1, -2, 3));
  EXPECT_EQ(robot.workspace.centre_m, Vec3(0.001, -0.002, 0.09));
  EXPECT_EQ(robot.workspace.radius_m, 0.012);
  EXPECT_EQ(robot.workspace.height_m, 0.004);
  EXPECT_EQ(robot.in_base({0.1, 0.2, 0.3}), Vec3(0.101, 0.198, 0.39));
  EXPECT_EQ(robot.in_workpiece(robot.in_base({0.25, 0.5, 0.125})), Vec3(0.25, 0.5, 0.125));
  EXPECT_EQ(parse_robot(with("assembly_mode = \"above\"", "assembly_mode = \"above\"\n"), "f")
                .geometry.working_mode,
            (std::array<int, 3>{1, 1, 1}));
}

TEST(RobotFile, WhatIsLeftOutFollowsWhatIsThere) {
  // Peak at least the continuous force, breakaway the Coulomb friction.
  const RobotModel strong =
      parse_robot(with("continuous_force_n = 3.25\npeak_force_n = 11.5\n", "continuous_force_n = 50\n"), "f");
  EXPECT_EQ(strong.motor.peak_force_n, 50);
  EXPECT_EQ(parse_robot(with("peak_force_n = 11.5\n", ""), "f").motor.peak_force_n, Motor{}.peak_force_n);
  EXPECT_EQ(parse_robot(with("breakaway_n = 0.25\n", ""), "f").friction.breakaway_n, 0.125);
  EXPECT_EQ(parse_robot(with("gravity_m_per_s2 = [1, -2, 3]\n", ""), "f").gravity_m_per_s2,
            Vec3(0, 0, -9.80665));
  EXPECT_EQ(parse_robot(with("name = \"mine\"\n", ""), "theirs").name, "theirs");
}

TEST(RobotFile, EveryKeyIsRefusedByNameJustOutsideOfItsBoundsAndTakenJustInside) {
  struct Case {
    const char* line;  ///< as it stands in the file
    const char* key;
    const char* good;
    const char* bad;
  };
  for (const Case& c : {
           Case{"mass_kg = 0.07\n", "motor.mass_kg", "1e-4", "0.99e-4"},
           Case{"mass_kg = 0.07\n", "motor.mass_kg", "1000", "1000.1"},
           Case{"force_constant_n_per_a = 6.5\n", "motor.force_constant_n_per_a", "1e-3", "0.99e-3"},
           Case{"force_constant_n_per_a = 6.5\n", "motor.force_constant_n_per_a", "1e4", "10001"},
           Case{"continuous_force_n = 3.25\n", "motor.continuous_force_n", "1e-3", "0.99e-3"},
           Case{"peak_force_n = 11.5\n", "motor.peak_force_n", "3.25", "3.24"},
           Case{"peak_force_n = 11.5\n", "motor.peak_force_n", "1e5", "100001"},
           Case{"drive_delay_s = 0.0015\n", "drive_delay_s", "0.02", "0.021"},
           Case{"drive_delay_s = 0.0015\n", "drive_delay_s", "0", "-1e-4"},
           Case{"mass_kg = 0.0625\n", "tool.mass_kg", "0", "-0.001"},
           Case{"mass_kg = 0.0625\n", "tool.mass_kg", "1000", "1000.1"},
           Case{"resolution_m = 0.25e-6\n", "sensor.resolution_m", "0", "-1e-9"},
           Case{"resolution_m = 0.25e-6\n", "sensor.resolution_m", "1e-3", "1.01e-3"},
           Case{"pitch_m = 0.019\n", "sensor.pitch_m", "1e-4", "0.99e-4"},
           Case{"pitch_m = 0.019\n", "sensor.pitch_m", "1", "1.01"},
           Case{"adc_bits = 14\n", "sensor.adc_bits", "4", "3"},
           Case{"adc_bits = 14\n", "sensor.adc_bits", "24", "25"},
           Case{"noise = 0.001\n", "sensor.noise", "0.1", "0.101"},
           Case{"conversions = 32\n", "sensor.conversions", "1", "0"},
           Case{"conversions = 32\n", "sensor.conversions", "256", "257"},
           Case{"conversion_s = 2e-6\n", "sensor.conversion_s", "0", "-1e-9"},
           Case{"conversion_s = 2e-6\n", "sensor.conversions", "3.1e-5", "3.2e-5"},
           Case{"gain_mismatch = 0.002\n", "sensor.gain_mismatch", "0.1", "0.101"},
           Case{"offset_mismatch = 0.003\n", "sensor.offset_mismatch", "0.1", "0.101"},
           Case{"phase_mismatch_rad = 0.004\n", "sensor.phase_mismatch_rad", "0.2", "0.201"},
           Case{"phase_mismatch_rad = 0.004\n", "sensor.phase_mismatch_rad", "0", "-0.001"},
           Case{"coulomb_n = 0.125\n", "friction.coulomb_n", "0", "-0.001"},
           Case{"breakaway_n = 0.25\n", "friction.breakaway_n", "0.125", "0.124"},
           Case{"viscous_n_s_per_m = 0.375\n", "friction.viscous_n_s_per_m", "0", "-0.001"},
           Case{"stribeck_velocity_m_per_s = 0.006\n", "friction.stribeck_velocity_m_per_s", "1e-4",
                "0.99e-4"},
           Case{"smoothing_velocity_m_per_s = 0.0007\n", "friction.smoothing_velocity_m_per_s", "1", "1.01"},
           Case{"velocity_m_per_s = 0.35\n", "limits.velocity_m_per_s", "1e-4", "0.99e-4"},
           Case{"velocity_m_per_s = 0.35\n", "limits.velocity_m_per_s", "100", "100.1"},
           Case{"acceleration_m_per_s2 = 21\n", "limits.acceleration_m_per_s2", "1e-3", "0.99e-3"},
           Case{"acceleration_m_per_s2 = 21\n", "limits.acceleration_m_per_s2", "1e4", "10001"},
           Case{"gravity_m_per_s2 = [1, -2, 3]\n", "mounting.gravity_m_per_s2", "[20, -20, 0]",
                "[20.1, 0, 0]"},
           Case{"stroke_m = [-0.001, 0.041]\n", "geometry.stroke_m", "[-0.002, 0.042]", "[0.01, 0.01]"},
           Case{"working_mode = [1, 1, 1]\n", "geometry.working_mode", "[1, 1, 1]", "[1, 1, 0.5]"},
           Case{"radius_m = 0.012\n", "workspace.radius_m", "1e-4", "0.99e-4"},
           Case{"radius_m = 0.012\n", "workspace.radius_m", "0.013", "0.08"},
           Case{"height_m = 0.004\n", "workspace.height_m", "0", "-0.001"},
       }) {
    std::string name = c.line;
    name = name.substr(0, name.find(" ="));
    EXPECT_EQ(refusal_of(with(c.line, name + " = " + c.good + "\n")), "") << c.key;
    const std::string said = refusal_of(with(c.line, name + " = " + c.bad + "\n"));
    EXPECT_NE(said.find(c.key), std::string::npos) << c.key << " = " << c.bad << ": '" << said << "'";
  }
}

TEST(RobotFile, AMismatchIsDrawnForEveryParameterOnItsOwn) {
  const RobotModel nominal = parse_robot(kEveryKey, "f");
  double mean[5] = {}, largest[5] = {};
  constexpr int kRobots = 2000;
  for (std::uint64_t seed = 1; seed <= kRobots; ++seed) {
    const RobotModel real = mismatched(nominal, 0.1, seed);
    const double share[5] = {real.motor.mass_kg / nominal.motor.mass_kg,
                             real.motor.force_constant_n_per_a / nominal.motor.force_constant_n_per_a,
                             real.tool_mass_kg / nominal.tool_mass_kg,
                             real.friction.coulomb_n / nominal.friction.coulomb_n,
                             real.friction.viscous_n_s_per_m / nominal.friction.viscous_n_s_per_m};
    for (int i = 0; i < 5; ++i) {
      mean[i] += (share[i] - 1.0) / kRobots;
      largest[i] = std::max(largest[i], std::abs(share[i] - 1.0));
    }
    EXPECT_DOUBLE_EQ(real.friction.breakaway_n, 2.0 * real.friction.coulomb_n)
        << "friction is worse as a whole";
    if (seed > 20) continue;
    for (int i = 0; i < 5; ++i) {
      for (int j = 0; j < i; ++j) EXPECT_NE(share[i], share[j]);
    }
  }
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(mean[i], 0.0, 0.006) << i << " three standard deviations of the mean";
    EXPECT_LE(largest[i], 0.1) << i;
    EXPECT_GT(largest[i], 0.0995) << i;
  }
  EXPECT_EQ(mismatched(nominal, 0.0, 3).motor.mass_kg, nominal.motor.mass_kg);
}

TEST(KinematicsErrors, AreSentences) {
  using Kind = KinematicsError::Kind;
  EXPECT_EQ(describe({Kind::kUnreachable, 1, 0.0125, 0}),
            "leg 2 cannot reach the pose: its rod is 0.0125 m too short");
  EXPECT_EQ(describe({Kind::kOutOfStroke, 0, 0.05, 0.04}),
            "leg 1 is out of stroke: 0.05 m is beyond its end at 0.04 m");
  EXPECT_EQ(describe({Kind::kSerialSingular, 2, 0, 0}).substr(0, 17), "leg 3 is singular");
  EXPECT_EQ(describe({Kind::kParallelSingular, -1, 0, 0}).substr(0, 21), "the robot is singular");
  EXPECT_NE(describe({Kind::kNotFinite, -1, 0, 0}).find("not finite"), std::string::npos);
  EXPECT_NE(describe({Kind::kOtherAssembly, -1, 0, 0}).find("working_mode"), std::string::npos);
}

}  // namespace
}  // namespace telekerf::robot
