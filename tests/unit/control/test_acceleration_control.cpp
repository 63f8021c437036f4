// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "common/control/acceleration_control.h"
#include "common/robot/drivers/simulated_robot.h"
#include "tests/unit/allocations.h"

namespace telekerf::control {
namespace {

using robot::DeltaKinematics;
using robot::RobotModel;
using robot::SimulatedRobot;

/// One joint of mass `mass`, force held per sample: exact motion.
struct Joint {
  double q = 0, v = 0;
  void step(double acceleration, double t) {
    q += t * v + 0.5 * t * t * acceleration;
    v += t * acceleration;
  }
};

// Eq. 22 with the corrected sign: plant A = A_n + dA, K = K_n + dK, constant external force.
TEST(DisturbanceObserver, FindsParametersAndExternalForceAsOneDisturbance) {
  const double t = 1e-3;
  const double mass_n = 0.4, mass = 0.5, k_n = 10, k = 9, external = 0.8, current = 0.2;
  DisturbanceObserver observer({t, 300, 900});
  Joint joint;
  observer.reset(Vec3::Zero());
  const double acceleration = (k * current - external) / mass;
  for (int i = 0; i < 200; ++i) {
    observer.applied(Vec3::Constant(k_n * current), mass_n * Mat3::Identity());
    joint.step(acceleration, t);
    observer.update(Vec3::Constant(joint.q), true);
  }
  const double printed_dk = k - k_n;  // opposite sign to dA: T_dis = -dK i + dA qdd + T_ext
  const double expected = -printed_dk * current + (mass - mass_n) * acceleration + external;
  EXPECT_NEAR(observer.disturbance_n()[0], expected, 1e-9);
  EXPECT_NEAR(observer.disturbance_n()[0], k_n * current - mass_n * acceleration, 1e-9);
  EXPECT_NEAR(observer.joint_velocity_m_per_s()[1], joint.v, 1e-12);
}

// The discrete design is exact: the error of position, velocity and disturbance dies with the poles that were
// asked for, whatever the sample period.
TEST(DisturbanceObserver, PolesAreWhereTheyWereAsked) {
  for (const double t : {1e-3, 1.0 / 2400, 5e-3}) {
    const double g = 200, f = 700;
    DisturbanceObserver observer({t, g, f});
    observer.reset(Vec3::Zero());
    observer.applied(Vec3::Zero(), Mat3::Identity());
    Joint joint;
    joint.v = 0.3;
    std::vector<double> errors;
    for (int i = 0; i < 8; ++i) {
      joint.step(-2.0, t);
      observer.update(Vec3::Constant(joint.q), true);
      errors.push_back(observer.disturbance_n()[0] - 2.0);
    }
    // The error sequence obeys e[k+3] = s1 e[k+2] - s2 e[k+1] + s3 e[k] with the symmetric sums of the poles.
    const double a = std::exp(-g * t), b = std::exp(-f * t);
    const double s1 = a + 2 * b, s2 = 2 * a * b + b * b, s3 = a * b * b;
    for (std::size_t k = 0; k + 3 < errors.size(); ++k) {
      const double expected = s1 * errors[k + 2] - s2 * errors[k + 1] + s3 * errors[k];
      EXPECT_NEAR(errors[k + 3], expected, 1e-9 * std::abs(errors[0])) << "period " << t;
    }
  }
}

TEST(DisturbanceObserver, BridgesMissingReadingsByItsModel) {
  const double t = 1e-3;
  DisturbanceObserver observer({t, 300, 900});
  Joint joint;
  observer.applied(Vec3::Constant(1.0), Mat3::Identity());
  for (int i = 0; i < 200; ++i) {
    joint.step(1.0 - 0.4, t);
    observer.update(Vec3::Constant(joint.q), true);
  }
  for (int i = 0; i < 50; ++i) {
    joint.step(1.0 - 0.4, t);
    observer.update(Vec3::Constant(std::nan("")), false);
  }
  EXPECT_NEAR(observer.joints_m()[0], joint.q, 1e-12);
  EXPECT_NEAR(observer.joint_velocity_m_per_s()[0], joint.v, 1e-12);
}

// The velocity estimate from 0.5 um counts is far quieter than a difference of two counts (0.2 mm/s rms at 1
// kHz).
TEST(DisturbanceObserver, VelocityFromCountsIsQuiet) {
  const double t = 1e-3, count = 0.5e-6;
  DisturbanceObserver observer({t, 300, 900});
  Joint joint;
  joint.v = 0.0123;
  observer.applied(Vec3::Zero(), Mat3::Identity());
  double sum = 0, difference_sum = 0, last = 0;
  const int settle = 100, count_samples = 2000;
  for (int i = 0; i < settle + count_samples; ++i) {
    joint.step(0, t);
    const double measured = std::floor(joint.q / count) * count;
    observer.update(Vec3::Constant(measured), true);
    if (i >= settle) {
      sum += std::pow(observer.joint_velocity_m_per_s()[0] - joint.v, 2);
      difference_sum += std::pow((measured - last) / t - joint.v, 2);
    }
    last = measured;
  }
  EXPECT_LT(std::sqrt(sum / count_samples), 0.6 * std::sqrt(difference_sum / count_samples));
  std::printf("velocity noise: observer %.1f um/s rms, difference %.1f um/s rms\n",
              1e6 * std::sqrt(sum / count_samples), 1e6 * std::sqrt(difference_sum / count_samples));
}

/// A robot under acceleration control that follows a given tool acceleration with PD feedback.
struct Rig {
  RobotModel nominal;
  SimulatedRobot plant;
  DeltaKinematics kinematics;
  AccelerationControl control;
  double period_s;

  Rig(const RobotModel& nominal_model, const RobotModel& real, DisturbanceObserver::Gains gains)
      : nominal(nominal_model),
        plant(real, 3, nominal_model.workspace.centre_m),
        kinematics(nominal_model.geometry),
        control(AccelerationControl::settings_for(nominal_model, gains)),
        period_s(gains.period_s) {
    control.reset(plant.read().joints_m);
  }

  /// One control step towards tool reference (position, velocity, acceleration), in base.
  void step(const Vec3& x, const Vec3& xd, const Vec3& xdd, bool compensate = true) {
    control.observe(plant.read());
    const auto state = kinematics.state(control.joints_m(), control.joint_velocity_m_per_s());
    ASSERT_TRUE(state.has_value()) << describe(state.error());
    constexpr double w = 60;
    const Vec3 wanted = xdd + 2 * w * (xd - state->tool_velocity_m_per_s) + w * w * (x - state->tool_m);
    const Vec3 compensation = compensate ? control.disturbance_n() : Vec3::Zero();
    plant.write(control.currents(state->joint_acceleration(wanted), robot::joint_inertia(nominal, *state),
                                 compensation));
    plant.advance(period_s);
  }
};

/// Circle of 5 mm at 1 Hz: rms error over the second turn, m.
double circle_rms(Rig& rig, bool compensate) {
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
    rig.step(x, xd, xdd, compensate);
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

TEST(AccelerationControl, TracksDespiteFrictionGravityAndMismatch) {
  for (const auto* name : {"master-horizontal", "slave-keops"}) {
    const RobotModel nominal = robot::load_robot(name);
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
      const RobotModel real = robot::mismatched(nominal, 0.2, seed);
      Rig with(nominal, real, {1e-3, 300, 900});
      Rig without(nominal, real, {1e-3, 300, 900});
      const double rejected = circle_rms(with, true);
      EXPECT_LT(rejected, 60e-6) << name << " seed " << seed;
      EXPECT_GT(circle_rms(without, false), 5 * rejected) << name << " seed " << seed;
      std::printf("%s, 20 %% off (seed %d): circle %.1f um rms\n", name, static_cast<int>(seed),
                  1e6 * rejected);
    }
  }
}

TEST(AccelerationControl, MoreBandwidthRejectsMore) {
  const RobotModel nominal = robot::load_robot("slave-keops");
  double last = 1;
  for (const double g : {30.0, 100.0, 300.0}) {
    Rig rig(nominal, robot::mismatched(nominal, 0.1, 1), {1e-3, g, 3 * g});
    const double rms = circle_rms(rig, true);
    EXPECT_LT(rms, last) << g;
    last = rms;
  }
}

TEST(AccelerationControl, EstimatesTheHandsForce) {
  const RobotModel nominal = robot::load_robot("master-horizontal");
  Rig rig(nominal, nominal, {1e-3, 300, 900});
  const Vec3 hand(1.5, -0.8, 2.0);
  rig.plant.set_tool_force(hand);
  for (int i = 0; i < 1000; ++i) rig.step(nominal.workspace.centre_m, Vec3::Zero(), Vec3::Zero());
  const auto state = rig.kinematics.state(rig.control.joints_m(), Vec3::Zero());
  const Vec3 estimate =
      reaction_force(nominal, rig.kinematics, *state, rig.control.disturbance_n(),
                     robot::friction_force(nominal.friction, state->joint_velocity_m_per_s));
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
    const auto at = clean.kinematics.state(clean.control.joints_m(), clean.control.joint_velocity_m_per_s());
    mean +=
        reaction_force(smooth, clean.kinematics, *at, clean.control.disturbance_n(), Vec3::Zero()) / kSamples;
  }
  EXPECT_LT((mean - hand).norm(), 0.005 * hand.norm());
}

// Anti-windup: a goal far beyond the motors' force, then back; the estimate stays the true disturbance
// throughout.
TEST(AccelerationControl, NothingWindsUpAtTheForceLimit) {
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
    const auto state = rig.kinematics.state(rig.control.joints_m(), rig.control.joint_velocity_m_per_s());
    ASSERT_TRUE(state.has_value());
    const Vec3 truth =
        robot::gravity_force(model, rig.kinematics, *state) + robot::coriolis_force(model, *state);
    worst = std::max(worst, (rig.control.disturbance_n() - truth).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(saturated, 10);
  EXPECT_LT(worst, 0.35);
}

TEST(AccelerationControl, NonsenseGivesNoCurrentAndNothingAllocates) {
  AccelerationControl control({{}, 6.0, 10.0});
  const auto before = telekerf::testing::allocations();
  control.observe({Vec3::Constant(.01), true, 1, 0});
  const Vec3 none = control.currents(Vec3::Constant(std::nan("")), Mat3::Identity(), Vec3::Zero());
  const Vec3 clipped = control.currents(Vec3(100, -100, 1), Mat3::Identity(), Vec3::Zero());
  EXPECT_EQ(telekerf::testing::allocations(), before);
  EXPECT_EQ(none, Vec3::Zero());
  EXPECT_TRUE(control.saturated());
  EXPECT_EQ(clipped, Vec3(10.0 / 6, -10.0 / 6, 1.0 / 6));
  [[maybe_unused]] const Mat3 inertia = Mat3::Identity();
  const robot::JointReading reading;
  static_assert(noexcept(control.observe(reading))&& noexcept(control.currents(none, inertia, none)));
}

}  // namespace
}  // namespace telekerf::control
