// SPDX-License-Identifier: Apache-2.0
// How old a drive's readings are, measured on simulated drives of which it is known.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/control/drive_delay.h"
#include "common/robot/drivers/simulated_robot.h"
#include "tests/unit/allocations.h"

namespace telekerf::control {
namespace {

using robot::SimulatedRobot;

/// A simulated drive whose robot is not its file's, and the trial on it.
struct Bench {
  std::string robot = "slave-keops";
  double delay_s = 0.0;
  double control_hz = 1000.0;
  double mismatch = 0.0;
  std::uint64_t seed = 1;
  double force_n = 0.0;
  double travel_m = 4e-3;
  double missing = 0.0;  ///< share of readings that never come
  double mass = 1.0, friction = 1.0, force_constant = 1.0;
  robot::Sensor::Kind sensor = robot::Sensor::Kind::kEncoder;

  robot::RobotModel nominal() const { return robot::load_robot(robot); }

  DriveTrial shaken() const {
    const robot::RobotModel file = nominal();
    robot::RobotModel truth = robot::mismatched(file, mismatch, seed);
    truth.drive_delay_s = delay_s;
    truth.sensor.kind = sensor;
    truth.motor.mass_kg *= mass;
    truth.tool_mass_kg *= mass;
    truth.motor.force_constant_n_per_a *= force_constant;
    truth.friction.coulomb_n *= friction;
    truth.friction.breakaway_n *= friction;
    truth.friction.viscous_n_s_per_m *= friction;
    SimulatedRobot plant(truth, seed, file.in_base(Vec3::Zero()));
    DriveTrial trial(file, {.control_hz = control_hz, .force_n = force_n, .travel_m = travel_m});
    std::mt19937_64 random(seed);
    while (trial.state() == DriveTrial::State::kRunning) {
      robot::JointReading reading = plant.read();
      reading.valid = static_cast<double>(random() >> 11) * 0x1p-53 >= missing;
      if (!reading.valid) reading.joints_m.setConstant(NAN);
      plant.write(trial.step(reading));
      plant.advance(1.0 / control_hz);
    }
    return trial;
  }

  tl::expected<DriveDelay, std::string> measured() const {
    const DriveTrial trial = shaken();
    EXPECT_EQ(trial.state(), DriveTrial::State::kDone);
    return estimate_drive_delay(trial.samples(), nominal().friction, 1.0 / control_hz, trial.highest_hz());
  }
};

/// The bound in control periods.
void expect_measured(const Bench& bench, double bound = 0.03) {
  const auto delay = bench.measured();
  ASSERT_TRUE(delay) << delay.error();
  EXPECT_NEAR(delay->delay_s * bench.control_hz, bench.delay_s * bench.control_hz, bound)
      << bench.robot << ", delay " << bench.delay_s << ", seed " << bench.seed;
  EXPECT_LE(delay->deviation_s * bench.control_hz, bound);
  EXPECT_GE(delay->spread_s, delay->deviation_s);
  for (const auto& joint : delay->joints) {
    EXPECT_NEAR(joint.delay_s, delay->delay_s, 1.5 * bound / bench.control_hz);
    EXPECT_GE(joint.explained, 0.98);
  }
}

constexpr double kDelays_s[] = {0.0, 0.5e-3, 1e-3, 1.5e-3, 2e-3};

TEST(DriveDelay, IsMeasuredOnRobotsThatAreNotTheirFile) {
  for (const double delay_s : kDelays_s) {
    for (const std::uint64_t seed : {1, 2}) {
      expect_measured({.delay_s = delay_s, .mismatch = 0.3, .seed = seed});
      expect_measured({.robot = "master-horizontal", .delay_s = delay_s, .mismatch = 0.3, .seed = seed});
    }
  }
}

TEST(DriveDelay, IsMeasuredWhateverTheMassesAndTheFriction) {
  for (const double mass : {0.7, 1.3}) {
    for (const double friction : {0.0, 2.0}) {
      expect_measured({.delay_s = 1e-3, .mass = mass, .friction = friction}, 0.06);
      expect_measured({.delay_s = 0.0, .mass = mass, .friction = friction}, 0.06);
    }
  }
}

TEST(DriveDelay, IsMeasuredAtOtherRatesAndWithHallSensors) {
  for (const double control_hz : {500.0, 2400.0})
    expect_measured({.delay_s = 1e-3, .control_hz = control_hz});
  expect_measured({.delay_s = 1e-3, .sensor = robot::Sensor::Kind::kHall}, 0.05);
}

TEST(DriveDelay, IsMeasuredThoughReadingsAreMissing) {
  expect_measured({.delay_s = 1e-3, .mismatch = 0.3, .missing = 0.02});
}

TEST(DriveDelay, TellsHowTheRobotAcceleratesAgainstItsFile) {
  const auto delay = Bench{.mass = 1.25, .friction = 0.0, .force_constant = 0.9}.measured();
  ASSERT_TRUE(delay) << delay.error();
  for (const auto& joint : delay->joints) EXPECT_NEAR(joint.gain, 0.9 / 1.25, 0.01);
}

TEST(DriveDelay, IsNotToldWhereFrictionHidesIt) {
  const auto delay = Bench{.delay_s = 1e-3, .force_n = 0.1}.measured();
  ASSERT_FALSE(delay);
  EXPECT_NE(delay.error().find("does not move as its force says"), std::string::npos) << delay.error();
}

TEST(DriveDelay, IsNotToldFromTooFewReadings) {
  const auto missing = Bench{.missing = 0.2}.measured();
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().find("% of the steps had no new reading"), std::string::npos) << missing.error();
  const auto few = estimate_drive_delay({}, {}, 1e-3, 80.0);
  ASSERT_FALSE(few);
  EXPECT_NE(few.error().find("only 0 steps"), std::string::npos) << few.error();
}

TEST(DriveDelay, OfALongWaitIsNotToldAtThisRate) {
  const auto delay = Bench{.delay_s = 4e-3, .control_hz = 2400.0}.measured();
  ASSERT_FALSE(delay);
  EXPECT_NE(delay.error().find("older than 8 control periods"), std::string::npos) << delay.error();
}

TEST(DriveDelay, IsNoneWhereTheJointsDisagree) {
  const Bench bench{.delay_s = 1e-3};
  const DriveTrial trial = bench.shaken();
  std::vector<DriveSample> samples = trial.samples();
  for (std::size_t k = 0; k + 2 < samples.size(); ++k) samples[k].joints_m[1] = samples[k + 2].joints_m[1];
  const auto delay = estimate_drive_delay(samples, bench.nominal().friction, 1e-3, trial.highest_hz());
  ASSERT_FALSE(delay);
  EXPECT_NE(delay.error().find("not the same in all joints"), std::string::npos) << delay.error();
}

TEST(DriveTrial, IsGentle) {
  const DriveTrial trial = Bench{.delay_s = 2e-3, .mismatch = 0.3}.shaken();
  EXPECT_LE(trial.farthest_m(), 1e-3);
  EXPECT_GE(trial.farthest_m(), 1e-4) << "it moved";
  EXPECT_LE(Bench{.travel_m = 1e-3}.shaken().force_n(), 0.95)
      << "the swing takes a tenth of the travel at most";
  EXPECT_DOUBLE_EQ(Bench{}.shaken().force_n(), 0.4 * 3.6) << "of the continuous force";
  EXPECT_EQ(Bench{.force_n = 1.5}.shaken().force_n(), 1.5);
}

TEST(DriveTrial, EndsWithoutCurrentWhereAJointGoesTooFar) {
  const robot::RobotModel file = robot::load_robot("slave-keops");
  DriveTrial trial(file, {});
  SimulatedRobot plant(file, 1, file.in_base(Vec3::Zero()));
  int steps = 0;
  for (; trial.state() == DriveTrial::State::kRunning && steps < 6000; ++steps) {
    plant.write(-trial.step(plant.read()));  // the sign of a joint is wrong
    plant.advance(1e-3);
  }
  EXPECT_EQ(trial.state(), DriveTrial::State::kTooFar);
  EXPECT_LT(steps, 500);
  EXPECT_TRUE(trial.step(plant.read()).isZero());
}

TEST(DriveTrial, EndsWhereTheReadingsAreNoPose) {
  const robot::RobotModel file = robot::load_robot("slave-keops");
  DriveTrial trial(file, {.travel_m = 10.0});
  EXPECT_TRUE(trial.step({}).isZero()) << "nothing was read yet";
  EXPECT_EQ(trial.state(), DriveTrial::State::kRunning);
  for (int k = 0; k < 1000 && trial.state() == DriveTrial::State::kRunning; ++k)
    EXPECT_TRUE(trial.step({Vec3(0.02, 0.02, 0.02 + 1e-3 * k), true}).allFinite());
  EXPECT_EQ(trial.state(), DriveTrial::State::kNoPose);
  EXPECT_TRUE(trial.step({Vec3::Constant(0.02), true}).isZero());
}

TEST(DriveTrial, AllocatesNothing) {
  const robot::RobotModel file = robot::load_robot("slave-keops");
  DriveTrial trial(file, {});
  const auto before = testing::allocations();
  for (int k = 0; k < 6000; ++k) (void)trial.step({Vec3::Constant(0.02), true});
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_EQ(trial.state(), DriveTrial::State::kDone);
  EXPECT_EQ(trial.samples().size(), 4000u);
}

}  // namespace
}  // namespace telekerf::control
