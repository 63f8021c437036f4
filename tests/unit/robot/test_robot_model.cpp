// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/robot/robot_model.h"
#include "common/runtime/resources.h"
#include "common/runtime/startup_error.h"

namespace telekerf::robot {
namespace {

constexpr const char* kGeometryOnly = R"([geometry]
base_radius_m = 0.12
tool_radius_m = 0.03
rod_length_m = [0.15, 0.15, 0.15]
rail_angle_deg = [90, 210, 330]
attack_angle_deg = [0, 0, 0]
assembly_mode = "above"
stroke_m = [-0.06, 0.06]
)";

std::string refusal_of(const std::string& toml) {
  try {
    (void)parse_robot(toml, "f.toml");
  } catch (const StartupError& refusal) {
    return refusal.what();
  }
  return "no refusal";
}

TEST(RobotModel, EveryShippedFileLoadsAndHasAUsefulWorkspace) {
  const auto names = shipped_names("robots", ".toml");
  ASSERT_GE(names.size(), 4u);
  for (const auto& name : names) {
    const RobotModel robot = load_robot(name);
    EXPECT_EQ(robot.name, name);
    EXPECT_GE(robot.workspace.radius_m, 0.015) << name;
    EXPECT_GE(robot.workspace.height_m, 0.005) << name;
    EXPECT_LE(worst_condition(DeltaKinematics(robot.geometry), robot.workspace), kWorstCondition) << name;
    std::printf("%-18s workspace radius %.1f mm, height %.1f mm, centre (%.1f, %.1f, %.1f) mm\n",
                name.c_str(), 1e3 * robot.workspace.radius_m, 1e3 * robot.workspace.height_m,
                1e3 * robot.workspace.centre_m.x(), 1e3 * robot.workspace.centre_m.y(),
                1e3 * robot.workspace.centre_m.z());
  }
}

TEST(RobotModel, TheWorkspacesAreAsLargeAsTheyWereFound) {
  struct Case {
    const char* name;
    double radius_m, height_m;
    Vec3 centre_m;
  };
  for (const Case& found : {Case{"asymmetric", 30.9e-3, 17.5e-3, {0, 11.0e-3, 86.8e-3}},
                            Case{"master-horizontal", 42.5e-3, 24.7e-3, {0, 0, 117.0e-3}},
                            Case{"slave-keops", 27.2e-3, 10.4e-3, {0, 0, 90.8e-3}},
                            Case{"vertical", 126.3e-3, 111.5e-3, {0, 0, 189.7e-3}}}) {
    const RobotModel robot = load_robot(found.name);
    EXPECT_NEAR(robot.workspace.radius_m, found.radius_m, 0.1e-3) << found.name;
    EXPECT_NEAR(robot.workspace.height_m, found.height_m, 0.1e-3) << found.name;
    EXPECT_LT((robot.workspace.centre_m - found.centre_m).norm(), 0.1e-3) << found.name;
    // A tenth of a millimetre more would leave what the rods can do: the radius is found to that step.
    const DeltaKinematics kinematics(robot.geometry);
    Workspace wider = robot.workspace;
    wider.radius_m += 0.2e-3;
    EXPECT_GT(worst_condition(kinematics, wider), kWorstCondition) << found.name;
    EXPECT_GT(worst_condition(kinematics, robot.workspace), 2.0) << found.name;
  }
}

TEST(RobotModel, AStricterConditionLeavesASmallerWorkspace) {
  const DeltaKinematics kinematics(load_robot("slave-keops").geometry);
  const Workspace strict = largest_cylinder(kinematics, 4.0);
  EXPECT_LE(worst_condition(kinematics, strict), 4.0);
  EXPECT_GT(worst_condition(kinematics, {strict.centre_m, strict.radius_m + 0.2e-3, strict.height_m}), 4.0);
  EXPECT_LT(strict.radius_m, 0.0272);
  EXPECT_TRUE(workable(kinematics, strict.centre_m, 4.0));
  EXPECT_FALSE(workable(kinematics, {0.5, 0, 0.09}));
}

TEST(RobotModel, EveryPointOfTheCylinderCanBeReached) {
  for (const auto& name : shipped_names("robots", ".toml")) {
    const RobotModel robot = load_robot(name);
    const DeltaKinematics kinematics(robot.geometry);
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int k = 0; k < 20000; ++k) {
      const Vec3 p(unit(random), unit(random), 0.5 * unit(random));
      if (std::hypot(p.x(), p.y()) > 1) continue;
      const Vec3 scaled(p.x() * robot.workspace.radius_m, p.y() * robot.workspace.radius_m,
                        p.z() * robot.workspace.height_m);
      ASSERT_TRUE(workable(kinematics, robot.in_base(scaled))) << name << " " << scaled.transpose();
    }
  }
}

TEST(RobotModel, GeometryAloneIsAFile) {
  const RobotModel robot = parse_robot(kGeometryOnly, "mine");
  EXPECT_EQ(robot.name, "mine");
  EXPECT_EQ(robot.geometry.working_mode, (std::array<int, 3>{1, 1, 1}));
  EXPECT_GT(robot.workspace.radius_m, 0.03);
  EXPECT_NEAR(robot.in_workpiece(robot.workspace.centre_m).norm(), 0, 0);
}

TEST(RobotModel, RefusalsNameTheKey) {
  const std::string good = kGeometryOnly;
  EXPECT_NE(refusal_of(good + "[motr]\nmass_kg = 1\n").find("motr.mass_kg"), std::string::npos);
  EXPECT_NE(refusal_of(good + "[motor]\nmass_kg = -1\n").find("motor.mass_kg"), std::string::npos);
  EXPECT_NE(refusal_of(good + "[sensor]\nkind = \"psychic\"\n").find("encoder, hall"), std::string::npos);
  EXPECT_NE(refusal_of(good + "[workspace]\ncentre_m = [0, 0, 0.1]\nradius_m = 0.2\nheight_m = 0.01\n")
                .find("cannot reach all of it"),
            std::string::npos);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_NE(refusal_of(with("stroke_m = [-0.06, 0.06]", "stroke_m = [0.06, -0.06]")).find("min below max"),
            std::string::npos);
  EXPECT_NE(refusal_of(with("\"above\"", "\"beside\"")).find("above, below"), std::string::npos);
  EXPECT_NE(refusal_of(with("assembly_mode = \"above\"\n", "")).find("assembly_mode"), std::string::npos);
  EXPECT_NE(refusal_of(with("[0, 0, 0]", "[0, 0]")).find("3 numbers"), std::string::npos);
  EXPECT_NE(refusal_of(with("rod_length_m = [0.15, 0.15, 0.15]", "rod_length_m = [0.01, 0.01, 0.01]"))
                .find("no workspace"),
            std::string::npos);
  EXPECT_NE(refusal_of(good + "working_mode = [1, 0, 1]\n").find("working_mode"), std::string::npos);
}

TEST(RobotModel, MismatchStaysWithinItsShareAndIsReproducible) {
  const RobotModel nominal = load_robot("slave-keops");
  const RobotModel a = mismatched(nominal, 0.1, 7);
  const RobotModel b = mismatched(nominal, 0.1, 7);
  EXPECT_EQ(a.motor.mass_kg, b.motor.mass_kg);
  EXPECT_NE(a.motor.mass_kg, mismatched(nominal, 0.1, 8).motor.mass_kg);
  EXPECT_NEAR(a.motor.mass_kg, nominal.motor.mass_kg, 0.1 * nominal.motor.mass_kg);
  EXPECT_NEAR(a.tool_mass_kg, nominal.tool_mass_kg, 0.1 * nominal.tool_mass_kg);
}

}  // namespace
}  // namespace telekerf::robot
