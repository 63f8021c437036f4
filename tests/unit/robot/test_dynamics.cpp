// SPDX-License-Identifier: Apache-2.0
// Forces of the model and of the simulated robot, each against its closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "common/robot/drivers/simulated_robot.h"
#include "common/robot/dynamics.h"

namespace telekerf::robot {
namespace {

TEST(Dynamics, FrictionIsCoulombBreakawayAndViscousAgainstTheMotion) {
  const Friction friction{.coulomb_n = 0.2,
                          .breakaway_n = 0.5,
                          .viscous_n_s_per_m = 3.0,
                          .stribeck_velocity_m_per_s = 5e-3,
                          .smoothing_velocity_m_per_s = 5e-4};
  for (const double v : {0.0, 1e-4, 5e-4, 2e-3, 5e-3, 0.01, 0.3}) {
    const double level = 0.2 + 0.3 * std::exp(-(v / 5e-3) * (v / 5e-3));
    const double expected = level * std::tanh(v / 5e-4) + 3.0 * v;
    EXPECT_LT((friction_force(friction, Vec3(v, -v, 0)) - Vec3(expected, -expected, 0)).norm(), 1e-15) << v;
  }
  EXPECT_NEAR(friction_force(friction, Vec3(0.3, 0, 0)).x(), 0.2 + 0.9, 1e-12) << "fast";
}

TEST(Dynamics, ForcesAreTheDerivativesOfTheEnergy) {
  const RobotModel robot = load_robot("asymmetric");
  const DeltaKinematics kinematics(robot.geometry);
  const Vec3 q = *kinematics.inverse(robot.in_base({2e-3, -3e-3, 1e-3}));
  const Vec3 qd(0.1, -0.2, 0.15);
  const double h = 1e-6;
  const auto at_rest = [&](const Vec3& at) { return *kinematics.state(at, Vec3::Zero()); };
  const Vec3 gravity = gravity_force(robot, kinematics, at_rest(q));
  for (int i = 0; i < 3; ++i) {
    const Vec3 step = h * Vec3::Unit(i);
    const double slope =
        (energy(robot, kinematics, at_rest(q + step)) - energy(robot, kinematics, at_rest(q - step))) /
        (2 * h);
    EXPECT_NEAR(gravity[i], slope, 1e-7) << i;
  }
  const DeltaState moving = *kinematics.state(q, qd);
  const Mat3 inertia = joint_inertia(robot, moving);
  EXPECT_NEAR(energy(robot, kinematics, moving) - energy(robot, kinematics, at_rest(q)),
              0.5 * qd.dot(inertia * qd), 1e-12);
  // Lagrange: the Coriolis force is M' q' less half the slope of q' M q'.
  Vec3 expected = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const Vec3 step = h * Vec3::Unit(i);
    const Mat3 slope =
        (joint_inertia(robot, at_rest(q + step)) - joint_inertia(robot, at_rest(q - step))) / (2 * h);
    expected += qd[i] * (slope * qd);
    expected[i] -= 0.5 * qd.dot(slope * qd);
  }
  EXPECT_LT((coriolis_force(robot, moving) - expected).norm(), 1e-6 * expected.norm() + 1e-9);
}

TEST(SimulatedRobot, AccelerationIsForceOverInertiaAndForceIsCurrentUpToThePeak) {
  RobotModel robot = load_robot("slave-keops");
  robot.friction = {};
  robot.gravity_m_per_s2.setZero();
  constexpr double kShort_s = 1e-5;
  for (const Vec3& currents : {Vec3(0.1, -0.2, 0.3), Vec3(100, -100, 0)}) {
    SimulatedRobot plant(robot, 1, robot.workspace.centre_m);
    const Mat3 inertia = joint_inertia(robot, plant.true_state());
    plant.write(currents);
    plant.advance(kShort_s);
    Vec3 force = robot.motor.force_constant_n_per_a * currents;
    force = force.cwiseMax(-robot.motor.peak_force_n).cwiseMin(robot.motor.peak_force_n);
    const Vec3 got = inertia * plant.true_state().joint_velocity_m_per_s / kShort_s;
    EXPECT_LT((got - force).norm(), 1e-4 * force.norm()) << currents.transpose();
    EXPECT_DOUBLE_EQ(plant.time_s(), kShort_s);
  }
}

TEST(SimulatedRobot, AStopIsAStiffDampedSpringFromTheEndOfTheRailOn) {
  RobotModel robot = load_robot("slave-keops");
  robot.gravity_m_per_s2.setZero();
  robot.friction = {};
  // A carriage that is pressed against its stop rests where spring and motor are even.
  const double spring_n_per_m = robot.motor.mass_kg * 1000.0 * 1000.0;
  for (const double way : {-1.0, 1.0}) {
    SimulatedRobot plant(robot, 1, robot.workspace.centre_m);
    const double force_n = way * 7.1;
    plant.write(Vec3::Constant(force_n / robot.motor.force_constant_n_per_a));
    plant.advance(0.6);
    const double end = way > 0 ? robot.geometry.stroke_max_m : robot.geometry.stroke_min_m;
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(plant.true_state().joints_m[i] - end, force_n / spring_n_per_m, 1e-9) << way;
    plant.write(Vec3::Zero());
    plant.advance(0.1);
    EXPECT_FALSE(plant.broken());
    const double back = way * (end - plant.true_state().joints_m[0]);
    EXPECT_GE(back, -1e-5) << "it lets go";
    EXPECT_LT(back, 5e-3);
  }
}

TEST(SimulatedRobot, SaysWhatItIsAndWhenItWasRead) {
  RobotModel robot = load_robot("slave-keops");
  SimulatedRobot plant(robot, 1, robot.workspace.centre_m);
  const Capabilities encoder = plant.capabilities();
  EXPECT_EQ(encoder.name, "slave-keops");
  EXPECT_TRUE(encoder.simulated);
  EXPECT_EQ(encoder.resolution_m, robot.sensor.resolution_m);
  EXPECT_EQ(encoder.peak_force_n, robot.motor.peak_force_n);
  EXPECT_DOUBLE_EQ(encoder.max_rate_hz, 1e4);
  robot.sensor.kind = Sensor::Kind::kHall;
  EXPECT_NEAR(SimulatedRobot(robot, 1, robot.workspace.centre_m).capabilities().resolution_m,
              0.018 / (2 * M_PI) * 1.25 / 32768, 1e-15);
  plant.advance(1.5e-3);
  const JointReading first = plant.read();
  EXPECT_EQ(first.tick, 1u);
  EXPECT_EQ(first.time_ns, 1'500'000);
  plant.advance(0.25e-3);
  EXPECT_EQ(plant.read().tick, 2u);
  EXPECT_EQ(plant.read().time_ns, 1'750'000);
}

// On average an encoder is right: half a count is the largest error, either way, and it is evenly spread.
TEST(SimulatedRobot, AnEncodersErrorHasNoBias) {
  RobotModel robot = load_robot("slave-keops");
  double sum = 0.0, squares = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SimulatedRobot plant(robot, seed, robot.workspace.centre_m);
    const Vec3 error = (plant.read().joints_m - plant.true_state().joints_m) / robot.sensor.resolution_m;
    sum += error.sum();
    squares += error.squaredNorm();
    count += 3;
  }
  EXPECT_NEAR(sum / count, 0.0, 0.02);
  EXPECT_NEAR(squares / count, 1.0 / 12.0, 0.005);
  robot.sensor.resolution_m = 0.0;
  SimulatedRobot perfect(robot, 1, robot.workspace.centre_m);
  EXPECT_EQ(perfect.read().joints_m, perfect.true_state().joints_m);
}

}  // namespace
}  // namespace telekerf::robot
