// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <cstdio>
#include <random>

#include "common/control/joint_acceleration_control.h"
#include "common/control/loop_design.h"
#include "common/control/tracking_law.h"
#include "common/robot/drivers/simulated_robot.h"
#include "tests/unit/allocations.h"

namespace telekerf::control {
namespace {

using robot::DeltaKinematics;
using robot::RobotModel;
using robot::SimulatedRobot;

/// A robot under acceleration control that follows a given tool acceleration with PD feedback.
struct Rig {
  RobotModel nominal;
  SimulatedRobot plant;
  DeltaKinematics kinematics;
  JointAccelerationControl control;
  double period_s;

  Rig(const RobotModel& nominal_model, const RobotModel& real, DisturbanceObserver::Gains gains)
      : nominal(nominal_model),
        plant(real, 3, nominal_model.workspace.centre_m),
        kinematics(nominal_model.geometry),
        control(nominal_model, {.observer = gains}),
        period_s(gains.period_s) {
    control.reset(plant.read().joints_m);
  }

  /// One control step towards tool reference (position, velocity, acceleration), in base.
  void step(const Vec3& x, const Vec3& xd, const Vec3& xdd) {
    ASSERT_TRUE(control.observe(plant.read()));
    const robot::DeltaState& state = control.state();
    constexpr double w = 60;
    const Vec3 wanted = xdd + 2 * w * (xd - state.tool_velocity_m_per_s) + w * w * (x - state.tool_m);
    plant.write(control.currents(state.joint_acceleration(wanted)));
    plant.advance(period_s);
  }
};

/// Circle of 5 mm at 1 Hz: rms error over the second turn, m.
double circle_rms(Rig& rig) {
  const Vec3 centre = rig.nominal.workspace.centre_m;
  const double r = 0.005, omega = 2 * M_PI;
  double sum = 0;
  int samples = 0;
  for (int i = 0; i * rig.period_s < 2.0; ++i) {
    const double time = i * rig.period_s;
    const double ease = std::min(1.0, time);  // from the centre out during the first turn
    const double c = std::cos(omega * time), s = std::sin(omega * time);
    const Vec3 x = centre + ease * r * Vec3(c, s, 0);
    const Vec3 xd = r * omega * ease * Vec3(-s, c, 0) + (ease < 1 ? Vec3(r * Vec3(c, s, 0)) : Vec3::Zero());
    const Vec3 xdd = -r * omega * omega * ease * Vec3(c, s, 0);
    rig.step(x, xd, xdd);
    if (time >= 1.2) {
      // The reference of this step is reached one period later.
      const double next = time + rig.period_s;
      const Vec3 want = centre + r * Vec3(std::cos(omega * next), std::sin(omega * next), 0);
      sum += (rig.plant.true_tool_in_base_m() - want).squaredNorm();
      ++samples;
    }
  }
  return std::sqrt(sum / samples);
}

TEST(JointAccelerationControl, TracksDespiteFrictionGravityAndMismatch) {
  for (const auto* name : {"master-horizontal", "slave-keops"}) {
    const RobotModel nominal = robot::load_robot(name);
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
      const RobotModel real = robot::mismatched(nominal, 0.2, seed);
      Rig with(nominal, real, {1e-3, 300, 900});
      Rig without(nominal, real, {1e-3, 0.01, 900});  // sees nothing of a turn's disturbance
      const double rejected = circle_rms(with);
      EXPECT_LT(rejected, 60e-6) << name << " seed " << seed;
      EXPECT_GT(circle_rms(without), 5 * rejected) << name << " seed " << seed;
      std::printf("%s, 20 %% off (seed %d): circle %.1f um rms\n", name, static_cast<int>(seed),
                  1e6 * rejected);
    }
  }
}

TEST(JointAccelerationControl, MoreBandwidthRejectsMore) {
  const RobotModel nominal = robot::load_robot("slave-keops");
  double last = 1;
  for (const double g : {30.0, 100.0, 300.0}) {
    Rig rig(nominal, robot::mismatched(nominal, 0.1, 1), {1e-3, g, 3 * g});
    const double rms = circle_rms(rig);
    EXPECT_LT(rms, last) << g;
    last = rms;
  }
}

TEST(JointAccelerationControl, EstimatesTheHandsForce) {
  const RobotModel nominal = robot::load_robot("master-horizontal");
  Rig rig(nominal, nominal, {1e-3, 300, 900});
  const Vec3 hand(1.5, -0.8, 2.0);
  rig.plant.set_tool_force(hand);
  for (int i = 0; i < 1000; ++i) rig.step(nominal.workspace.centre_m, Vec3::Zero(), Vec3::Zero());
  const Vec3 estimate = rig.control.reaction_force_n();
  // At rest Coulomb friction may hold a part: at most one breakaway force a joint.
  EXPECT_LT((estimate - hand).norm(), 3 * nominal.friction.breakaway_n);

  RobotModel smooth = nominal;
  smooth.friction = {};
  Rig clean(smooth, smooth, {1e-3, 300, 900});
  clean.plant.set_tool_force(hand);
  for (int i = 0; i < 1000; ++i) clean.step(nominal.workspace.centre_m, Vec3::Zero(), Vec3::Zero());
  Vec3 mean = Vec3::Zero();  // single samples carry the sensor's counts
  constexpr int kSamples = 200;
  for (int i = 0; i < kSamples; ++i) {
    clean.step(nominal.workspace.centre_m, Vec3::Zero(), Vec3::Zero());
    mean += clean.control.reaction_force_n() / kSamples;
  }
  EXPECT_LT((mean - hand).norm(), 0.005 * hand.norm());
}

// Anti-windup: a goal far beyond the motors' force, then back; the estimate stays the true disturbance
// throughout.
TEST(JointAccelerationControl, NothingWindsUpAtTheForceLimit) {
  RobotModel model = robot::load_robot("slave-keops");
  model.friction = {};
  model.motor.peak_force_n = 1.5;
  model.motor.continuous_force_n = 1.5;
  Rig rig(model, model, {1e-3, 300, 900});
  const Vec3 centre = model.workspace.centre_m;
  for (int i = 0; i < 300; ++i) rig.step(centre, Vec3::Zero(), Vec3::Zero());
  int saturated = 0;
  double worst = 0;
  for (int i = 0; i < 100; ++i) {
    rig.step(centre + Vec3(0.02, 0, 0), Vec3::Zero(), Vec3::Zero());
    if (rig.control.saturated()) ++saturated;
    const robot::DeltaState& state = rig.control.state();
    const Vec3 truth =
        robot::gravity_force(model, rig.kinematics, state) + robot::coriolis_force(model, state);
    worst = std::max(worst, (rig.control.disturbance_n() - truth).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(saturated, 10);
  EXPECT_LT(worst, 0.3);
}

TEST(JointAccelerationControl, NonsenseGivesNoCurrentAndNothingAllocates) {
  RobotModel model = robot::load_robot("slave-keops");
  model.motor.force_constant_n_per_a = 6.0;
  model.motor.peak_force_n = 10.0;
  const Vec3 joints = *DeltaKinematics(model.geometry).inverse(model.workspace.centre_m);
  JointAccelerationControl control(model, {});
  control.reset(joints);
  const auto before = telekerf::testing::allocations();
  EXPECT_TRUE(control.observe({joints, true, 1, 0}));
  const Vec3 none = control.currents(Vec3::Constant(std::nan("")));
  const Mat3 inertia = robot::joint_inertia(model, control.state());
  const Vec3 clipped = control.currents(inertia.inverse() * Vec3(100, -100, 1));
  EXPECT_EQ(telekerf::testing::allocations(), before);
  EXPECT_EQ(none, Vec3::Zero());
  EXPECT_TRUE(control.saturated());
  EXPECT_LT((clipped - Vec3(10.0 / 6, -10.0 / 6, 1.0 / 6)).norm(), 1e-12);
  const robot::JointReading reading;
  static_assert(noexcept(control.observe(reading))&& noexcept(control.currents(none, none)));
}

// What a model expects is given, and not estimated a second time.
TEST(JointAccelerationControl, KnownForcesAreNoDisturbance) {
  RobotModel model = robot::load_robot("slave-keops");
  model.friction = {};
  Rig rig(model, model, {1e-3, 300, 900});
  const Vec3 centre = model.workspace.centre_m;
  double unknown_n = 0;
  for (int i = 0; i < 600; ++i) {
    ASSERT_TRUE(rig.control.observe(rig.plant.read()));
    const robot::DeltaState& state = rig.control.state();
    const Vec3 wanted = 3600 * (centre - state.tool_m) - 120 * state.tool_velocity_m_per_s;
    rig.plant.write(rig.control.currents(state.joint_acceleration(wanted),
                                         robot::gravity_force(model, rig.kinematics, state)));
    rig.plant.advance(1e-3);
    if (i > 300) unknown_n = std::max(unknown_n, rig.control.disturbance_n().norm());
  }
  const double weight_n = robot::gravity_force(model, rig.kinematics, rig.control.state()).norm();
  EXPECT_GT(weight_n, 0.5);
  EXPECT_LT(unknown_n, 0.03 * weight_n);
}

/// Largest distance from a circle of 8 mm at 30 mm/s, by the loop that is chosen for the drive, when only now
/// and then a reading comes: evenly, or after 1 to `apart` steps.
double farthest_m(double delay_s, int apart, bool evenly) {
  RobotModel model = robot::load_robot("slave-keops");
  model.drive_delay_s = delay_s;
  const LoopBandwidths loop = design_loop(loop_conditions(model, 1000.0));
  const SampledGains law = sampled_gains(loop.law_rad_per_s, 1.0, 1e-3);
  JointAccelerationControl control(model, joints_of(model, loop, 1000.0));
  SimulatedRobot plant(robot::mismatched(model, 0.1, 2), 2, model.workspace.centre_m);
  control.reset(plant.read().joints_m);
  std::mt19937_64 random(1);
  double farthest = 0.0;
  for (int i = 0, next = 500; i < 6000; ++i) {
    robot::JointReading reading = plant.read();
    if (i > 500 && i < next) reading = {};
    if (i == next) next += evenly ? apart : 1 + static_cast<int>(random() % static_cast<unsigned>(apart));
    EXPECT_TRUE(control.observe(reading));
    const double time_s = 1e-3 * i, omega = 3.75, r = 8e-3 * std::min(1.0, 2.0 * time_s);
    const Vec3 out(std::cos(omega * time_s), std::sin(omega * time_s), 0.0);
    const KinematicState goal{.position_m = model.workspace.centre_m + r * out,
                              .velocity_m_per_s = r * omega * Vec3(-out.y(), out.x(), 0.0),
                              .acceleration_m_per_s2 = -r * omega * omega * out};
    const robot::DeltaState& state = control.state();
    const KinematicState tool{.position_m = state.tool_m, .velocity_m_per_s = state.tool_velocity_m_per_s};
    plant.write(control.currents(state.joint_acceleration(
        limited(tracking_acceleration(goal, tool, law), model.limits.acceleration_m_per_s2))));
    if (i > 1500) farthest = std::max(farthest, (plant.true_tool_in_base_m() - goal.position_m).norm());
    plant.advance(1e-3);
  }
  return farthest;
}

TEST(JointAccelerationControl, FollowsThoughMostReadingsAreMissing) {
  for (const int apart : {2, 4, 8}) {
    for (const bool evenly : {true, false}) {
      EXPECT_LT(farthest_m(0.0, apart, evenly), 8e-6 * apart) << apart << (evenly ? " evenly" : " at random");
      EXPECT_LT(farthest_m(1e-3, apart, evenly), 12e-6 * apart)
          << apart << (evenly ? " evenly" : " at random");
    }
  }
}

TEST(JointAccelerationControl, JointsThatAreNoPoseAreBrakedWhereTheyAre) {
  const RobotModel model = robot::load_robot("slave-keops");
  const Vec3 joints = *DeltaKinematics(model.geometry).inverse(model.workspace.centre_m);
  JointAccelerationControl control(model, {});
  control.reset(joints);
  ASSERT_TRUE(control.observe({joints, true, 1, 0}));
  const Vec3 tool_m = control.state().tool_m;
  control.reset(Vec3::Constant(10.0));
  EXPECT_FALSE(control.observe({Vec3::Constant(10.001), true, 2, 0}));
  EXPECT_FALSE(control.posed());
  EXPECT_EQ(control.state().tool_m, tool_m) << "the last pose that was one";
  EXPECT_GT(control.joint_velocity_m_per_s()[0], 0.0);
  EXPECT_EQ(control.braking_m_per_s2(60), -120 * control.joint_velocity_m_per_s());
}

}  // namespace
}  // namespace telekerf::control
