// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "common/robot/drivers/simulated_robot.h"
#include "common/robot/sensor_noise.h"
#include "common/runtime/startup_error.h"

namespace telekerf::robot {
namespace {

RobotModel frictionless(const std::string& name) {
  RobotModel robot = load_robot(name);
  robot.friction = {};
  return robot;
}

TEST(SimulatedRobot, ConservesEnergyWithoutFriction) {
  for (const auto* name : {"master-horizontal", "slave-keops", "vertical", "asymmetric"}) {
    RobotModel robot = frictionless(name);
    robot.gravity_m_per_s2 *= 0.1;  // stays between the stops for a while
    SimulatedRobot plant(robot, 1, robot.workspace.centre_m);
    // A kick sideways, then free flight.
    plant.set_tool_force({0.5, 0.3, 0});
    plant.advance(0.02);
    plant.set_tool_force(Vec3::Zero());
    const double start = plant.energy_j();
    double moved = 0;
    double worst = 0;
    const Vec3 from = plant.true_tool_in_base_m();
    for (int i = 0; i < 60; ++i) {
      plant.advance(1e-3);
      worst = std::max(worst, std::abs(plant.energy_j() - start));
      moved = std::max(moved, (plant.true_tool_in_base_m() - from).norm());
      const auto& q = plant.true_state().joints_m;
      ASSERT_GE(q.minCoeff(), robot.geometry.stroke_min_m) << name;
      ASSERT_LE(q.maxCoeff(), robot.geometry.stroke_max_m) << name;
    }
    EXPECT_GT(moved, 5e-4) << name;
    const double kinetic = 0.5 * robot.tool_mass_kg * plant.true_tool_velocity_m_per_s().squaredNorm();
    EXPECT_LT(worst, 1e-9 * kinetic) << name;
  }
}

// Power balance: what motors and hand put in is what the energy gains (forces over paths, no friction).
TEST(SimulatedRobot, WorkOfMotorsAndHandIsEnergy) {
  const RobotModel robot = frictionless("slave-keops");
  SimulatedRobot plant(robot, 1, robot.workspace.centre_m);
  const Vec3 currents(0.15, 0.10, 0.20);
  const Vec3 hand(0.2, -0.1, 0.3);
  plant.write(currents);
  plant.set_tool_force(hand);
  const double start = plant.energy_j();
  const Vec3 q0 = plant.true_state().joints_m;
  const Vec3 x0 = plant.true_tool_in_base_m();
  plant.advance(0.03);
  const double work = robot.motor.force_constant_n_per_a * currents.dot(plant.true_state().joints_m - q0) +
                      hand.dot(plant.true_tool_in_base_m() - x0);
  EXPECT_GT(std::abs(work), 1e-6);
  EXPECT_NEAR(plant.energy_j() - start, work, 1e-8 * std::abs(work));
}

TEST(SimulatedRobot, StandsStillUnderGravityWhenHeld) {
  const RobotModel robot = load_robot("slave-keops");
  SimulatedRobot plant(robot, 1, robot.workspace.centre_m);
  const DeltaKinematics kinematics(robot.geometry);
  plant.write(gravity_force(robot, kinematics, plant.true_state()) / robot.motor.force_constant_n_per_a);
  plant.advance(0.5);
  EXPECT_LT((plant.true_tool_in_base_m() - robot.workspace.centre_m).norm(), 1e-9);
}

TEST(SimulatedRobot, FrictionTakesEnergyAndStops) {
  RobotModel robot = load_robot("master-horizontal");
  robot.gravity_m_per_s2.setZero();
  SimulatedRobot plant(robot, 1, robot.workspace.centre_m);
  plant.set_tool_force({3, 0, 0});
  plant.advance(0.05);
  plant.set_tool_force(Vec3::Zero());
  double last = plant.energy_j();
  EXPECT_GT(last, 1e-4);
  for (int i = 0; i < 500; ++i) {
    plant.advance(1e-3);
    EXPECT_LE(plant.energy_j(), last + 1e-15);
    last = plant.energy_j();
  }
  EXPECT_LT(last, 1e-9);
}

TEST(SimulatedRobot, EndStopsHoldUnderFullForce) {
  const RobotModel robot = load_robot("slave-keops");
  SimulatedRobot plant(robot, 1, robot.workspace.centre_m);
  for (const double current : {10.0, -10.0}) {
    plant.write(Vec3::Constant(current));
    plant.advance(1.0);
    EXPECT_FALSE(plant.broken());
    EXPECT_LT(plant.true_state().joint_velocity_m_per_s.norm(), 1e-3);
    const double end = current > 0 ? robot.geometry.stroke_max_m : robot.geometry.stroke_min_m;
    EXPECT_LT((plant.true_state().joints_m - Vec3::Constant(end)).cwiseAbs().maxCoeff(), 5e-4);
  }
}

TEST(SimulatedRobot, ReadsWholeCountsAndIsReproducible) {
  const RobotModel robot = load_robot("slave-keops");
  SimulatedRobot a(robot, 5, robot.workspace.centre_m);
  SimulatedRobot b(robot, 5, robot.workspace.centre_m);
  SimulatedRobot other(robot, 6, robot.workspace.centre_m);
  EXPECT_NE(a.read().joints_m, other.read().joints_m);
  b.read();
  const Vec3 first = a.read().joints_m;
  b.read();
  for (int i = 0; i < 50; ++i) {
    a.write(Vec3(.1, .2, .1));
    b.write(Vec3(.1, .2, .1));
    a.advance(1e-3);
    b.advance(1e-3);
    const JointReading reading = a.read();
    EXPECT_EQ(reading.joints_m, b.read().joints_m);
    EXPECT_TRUE(reading.valid);
    const Vec3 counts = (reading.joints_m - first) / robot.sensor.resolution_m;
    EXPECT_LT((counts - Vec3(counts.array().round())).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LE((reading.joints_m - a.true_state().joints_m).cwiseAbs().maxCoeff(),
              0.5 * robot.sensor.resolution_m + 1e-15);
  }
}

TEST(SimulatedRobot, HallSensorsFollowTheJointsOnceCalibrated) {
  RobotModel robot = load_robot("slave-keops");
  robot.sensor.kind = Sensor::Kind::kHall;
  const auto worst_error = [&robot](bool calibrated) {
    robot.sensor.calibrated = calibrated;
    SimulatedRobot plant(robot, 5, robot.workspace.centre_m);
    double worst = 0;
    for (int i = 0; i < 300; ++i) {
      plant.write(Vec3::Constant(0.2 + 0.3 * std::sin(0.05 * i)));
      plant.advance(1e-3);
      const auto& state = plant.true_state();
      const double age_s = 0.5 * (robot.sensor.conversions - 1) * robot.sensor.conversion_s;
      const Vec3 then_m = state.joints_m - age_s * state.joint_velocity_m_per_s;
      worst = std::max(worst, (plant.read().joints_m - then_m).cwiseAbs().maxCoeff());
    }
    return worst;
  };
  EXPECT_LT(worst_error(true), 1e-6);
  EXPECT_GT(worst_error(false), 10e-6);
}

TEST(SimulatedRobot, HomingDoesNotKeepTheNoiseOfAReading) {
  RobotModel robot = load_robot("slave-keops");
  robot.sensor.kind = Sensor::Kind::kHall;
  double squares = 0, noise = 0;
  constexpr int kRobots = 20, kReadings = 1000;
  for (std::uint64_t seed = 1; seed <= kRobots; ++seed) {
    SimulatedRobot plant(robot, seed, robot.in_base(Vec3::Zero()));
    const Vec3 truth = plant.true_state().joints_m;
    Vec3 mean = Vec3::Zero();
    for (int i = 0; i < kReadings; ++i) {
      const Vec3 error = plant.read().joints_m - truth;
      mean += error / kReadings;
      noise += error.squaredNorm() / (3.0 * kReadings * kRobots);
    }
    squares += mean.squaredNorm() / (3.0 * kRobots);
  }
  EXPECT_NEAR(std::sqrt(noise), reading_noise_m(robot.sensor), 0.05 * std::sqrt(noise));
  EXPECT_LT(std::sqrt(squares), 0.15 * std::sqrt(noise));
}

TEST(SimulatedRobot, SurvivesNonsense) {
  const RobotModel robot = load_robot("master-horizontal");
  SimulatedRobot plant(robot, 1, robot.workspace.centre_m);
  plant.write(Vec3::Constant(std::nan("")));
  plant.advance(0.01);
  EXPECT_TRUE(plant.true_tool_in_base_m().allFinite());
  EXPECT_THROW(SimulatedRobot(robot, 1, Vec3(1, 1, 1)), StartupError);
}

TEST(SimulatedRobot, StepSizeDoesNotMatter) {
  const RobotModel robot = load_robot("slave-keops");
  SimulatedRobot coarse(robot, 1, robot.workspace.centre_m);
  SimulatedRobot fine(robot, 1, robot.workspace.centre_m);
  for (auto* plant : {&coarse, &fine}) plant->write(Vec3(.12, .14, .2));
  for (int i = 0; i < 40; ++i) coarse.advance(1e-3);
  for (int i = 0; i < 4000; ++i) fine.advance(1e-5);
  EXPECT_GT((coarse.true_tool_in_base_m() - robot.workspace.centre_m).norm(), 1e-3);
  EXPECT_LT((coarse.true_tool_in_base_m() - fine.true_tool_in_base_m()).norm(), 1e-8);
}

TEST(SimulatedRobot, ItsReadingsAreAsOldAsItsDrive) {
  for (const double delay_s : {0.0, 0.4e-3, 1e-3, 2.5e-3}) {
    RobotModel robot = load_robot("slave-keops");
    robot.drive_delay_s = delay_s;
    robot.sensor.resolution_m = 0.0;
    SimulatedRobot plant(robot, 1, robot.workspace.centre_m);
    plant.write(Vec3(0.3, 0.2, 0.25));
    std::vector<Vec3> joints_m{plant.true_state().joints_m};
    EXPECT_EQ(plant.read().joints_m, joints_m[0]) << "where it has always been";
    for (int i = 1; i <= 30; ++i) {
      plant.advance(1e-3);
      joints_m.push_back(plant.true_state().joints_m);
      const double then = std::max(0.0, i - delay_s * 1e3);
      const auto before = static_cast<std::size_t>(then);
      const Vec3& a = joints_m[before];
      const Vec3& b = joints_m[std::min(before + 1, joints_m.size() - 1)];
      const Vec3 expected = a + (then - static_cast<double>(before)) * (b - a);
      EXPECT_LT((plant.read().joints_m - expected).norm(), 1e-12) << delay_s << " " << i;
    }
    EXPECT_GT((joints_m.back() - joints_m.front()).norm(), 1e-3);
  }
}

}  // namespace
}  // namespace telekerf::robot
