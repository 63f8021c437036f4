// SPDX-License-Identifier: Apache-2.0
// A good robot is believed, whatever it is within 30 % off its file; a sensor that slips or sticks is not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "common/control/joint_acceleration_control.h"
#include "common/control/loop_design.h"
#include "common/control/standstill.h"
#include "common/control/tracking_law.h"
#include "common/robot/drivers/simulated_robot.h"

namespace telekerf::control {
namespace {

using Kind = robot::Doubt::Kind;

struct Lie {
  double at_s = 1e9;
  std::function<void(robot::JointReading&)> tell = [](robot::JointReading&) {};
};

/// A robot on a circle of 5 mm at 20 mm/s, with its own bandwidths.
class Watched {
 public:
  Watched(const std::string& name, double mismatch, std::uint64_t seed, bool weightless = false)
      : model_(robot::load_robot(name)),
        plant_(truth(robot::mismatched(model_, mismatch, seed), weightless), seed, model_.workspace.centre_m),
        bandwidths_(design_loop(loop_conditions(model_, 1000.0))),
        law_(sampled_gains(bandwidths_.law_rad_per_s, 1.0, 1e-3)),
        control_(model_, judged()),
        standstill_(model_.sensor, 1e-3) {
    control_.reset(plant_.read().joints_m);
  }
  /// False: a doubt.
  bool run(double seconds, const Lie& lie = {}) {
    for (int n = 0; n * 1e-3 < seconds; ++n, time_s_ += 1e-3) {
      robot::JointReading reading = plant_.read();
      if (time_s_ >= lie.at_s - 1e-9) lie.tell(reading);
      (void)control_.observe(reading);
      if (!control_.measured() && !doubted_s_) doubted_s_ = time_s_;
      if (control_.doubt()) return false;
      const KinematicState wanted = circle();
      const auto& pose = control_.state();
      const KinematicState tool{.position_m = pose.tool_m - model_.workspace.centre_m,
                                .velocity_m_per_s = pose.tool_velocity_m_per_s};
      const Vec3 asked = pose.joint_acceleration(
          limited(tracking_acceleration(wanted, tool, law_), model_.limits.acceleration_m_per_s2));
      const Vec3 error_m = pose.inverse_jacobian * (wanted.position_m - tool.position_m);
      plant_.write(control_.currents(standstill_.step(wanted, error_m, reading, asked)));
      const Vec3 before_m_per_s = plant_.true_tool_velocity_m_per_s();
      plant_.advance(1e-3);
      hardest_m_per_s2_ =
          std::max(hardest_m_per_s2_, 1e3 * (plant_.true_tool_velocity_m_per_s() - before_m_per_s).norm());
      off_m_ = (plant_.true_tool_in_base_m() - model_.workspace.centre_m - wanted.position_m).norm();
    }
    return true;
  }
  const robot::Doubt& doubt() const { return control_.doubt(); }
  double time_s() const { return time_s_; }
  double doubted_s() const { return doubted_s_.value_or(1e9); }  ///< the first reading that was not believed
  void stand_still() { speed_rad_per_s_ = 0.0; }
  /// Largest acceleration of the true tool, of the robot's limit.
  double hardest() const { return hardest_m_per_s2_ / model_.limits.acceleration_m_per_s2; }
  double off_m() const { return off_m_; }  ///< the true tool from where it is to be

 private:
  static robot::RobotModel truth(robot::RobotModel real, bool weightless) {
    if (weightless) real.gravity_m_per_s2.setZero();
    return real;
  }
  JointAccelerationSettings judged() const {
    JointAccelerationSettings settings = joints_of(model_, bandwidths_, 1000.0);
    settings.judged = true;
    return settings;
  }
  KinematicState circle() const {
    const double w = speed_rad_per_s_, r = w > 0.0 ? 5e-3 * std::min(1.0, time_s_) : 0.0, phi = w * time_s_;
    return {.position_m = r * Vec3(std::cos(phi), std::sin(phi), 0.0),
            .velocity_m_per_s = r * w * Vec3(-std::sin(phi), std::cos(phi), 0.0),
            .acceleration_m_per_s2 = -r * w * w * Vec3(std::cos(phi), std::sin(phi), 0.0)};
  }

  robot::RobotModel model_;
  robot::SimulatedRobot plant_;
  LoopBandwidths bandwidths_;
  SampledGains law_;
  JointAccelerationControl control_;
  Standstill standstill_;
  double time_s_ = 0.0;
  double off_m_ = 0.0;
  double hardest_m_per_s2_ = 0.0;
  double speed_rad_per_s_ = 4.0;
  std::optional<double> doubted_s_;
};

TEST(JointPlausibility, ARobotThatIsThirtyPercentOffItsFileIsBelieved) {
  for (const char* name : {"slave-keops", "master-horizontal", "vertical", "asymmetric"}) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      Watched robot(name, 0.3, seed);
      EXPECT_TRUE(robot.run(3.0)) << name << " " << seed << " " << robot.doubt().value;
      EXPECT_EQ(robot.doubted_s(), 1e9) << name << " " << seed << ": each single reading";
    }
  }
}

TEST(JointPlausibility, ASlipIsNotBelievedForAStepAndStopsTheRobotInTheNext) {
  for (const int joint : {0, 1, 2}) {
    for (const double slip_m : {20e-6, -20e-6, 0.6e-3}) {
      Watched robot("slave-keops", 0.1, 5);
      const bool good =
          robot.run(3.0, {2.0, [&](robot::JointReading& reading) { reading.joints_m[joint] += slip_m; }});
      EXPECT_FALSE(good);
      EXPECT_EQ(robot.doubt().kind, Kind::kReading);
      EXPECT_EQ(robot.doubt().joint, joint);
      EXPECT_NEAR(robot.doubt().value, slip_m, 10e-6);
      EXPECT_NEAR(robot.doubted_s(), 2.0, 1e-6);
      EXPECT_NEAR(robot.time_s(), 2.001, 1e-6);
      EXPECT_LT(robot.off_m(), 20e-6) << "nothing follows what is not believed";
    }
  }
}

TEST(JointPlausibility, ASlipIsNoticedAsSoonAsAFewReadingsWereWhereTheyAreToBe) {
  for (const double slip_m : {60e-6, -0.3e-3, 0.6e-3}) {
    Watched robot("slave-keops", 0.1, 5);
    EXPECT_FALSE(
        robot.run(0.1, {0.012, [&](robot::JointReading& reading) { reading.joints_m[0] += slip_m; }}));
    EXPECT_EQ(robot.doubt().kind, Kind::kReading);
    EXPECT_NEAR(robot.time_s(), 0.013, 1e-6) << slip_m;
  }
}

TEST(JointPlausibility, WhatNoJointCanHaveMovedIsNoticedFromTheFirstStepOn) {
  for (const double at_s : {0.001, 0.002, 0.004}) {
    Watched robot("slave-keops", 0.1, 5);
    EXPECT_FALSE(robot.run(0.1, {at_s, [&](robot::JointReading& reading) { reading.joints_m[2] += 3e-3; }}));
    EXPECT_EQ(robot.doubt().kind, Kind::kReading);
    EXPECT_NEAR(robot.time_s(), at_s + 0.001, 1e-6);
    EXPECT_LT(robot.hardest(), 1.0);
  }
}

TEST(JointPlausibility, WhateverASensorSaysTheRobotIsNotAcceleratedBeyondItsLimit) {
  for (const double at_s : {0.001, 0.002, 0.003, 0.005, 0.008, 0.02, 2.0}) {
    for (const double slip_m : {30e-6, -0.2e-3, 0.6e-3}) {
      Watched slips("slave-keops", 0.1, 5);
      (void)slips.run(at_s + 0.05, {at_s, [&](robot::JointReading& r) { r.joints_m[1] -= slip_m; }});
      EXPECT_LT(slips.hardest(), 1.1) << at_s << " " << slip_m;
    }
    Watched sticks("slave-keops", 0.1, 5);
    std::optional<double> stuck_m;
    (void)sticks.run(at_s + 0.1, {at_s, [&](robot::JointReading& r) {
                                    if (!stuck_m) stuck_m = r.joints_m[0];
                                    r.joints_m[0] = *stuck_m;
                                  }});
    EXPECT_LT(sticks.hardest(), 1.1) << at_s;
  }
}

/// Nobody can tell it from a joint that rests; but nothing is wound up that would push it away.
TEST(JointPlausibility, WhereASensorSticksAtRestTheToolCreepsAtTheMost) {
  double farthest_m = 0.0;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
    for (const int joint : {0, 1, 2}) {
      Watched robot("slave-keops", 0.1, seed);
      robot.stand_still();
      std::optional<double> stuck_m;
      (void)robot.run(1.4, {0.4, [&](robot::JointReading& reading) {
                              if (!stuck_m) stuck_m = reading.joints_m[joint];
                              reading.joints_m[joint] = *stuck_m;
                            }});
      farthest_m = std::max(farthest_m, robot.off_m());
      EXPECT_LT(robot.hardest(), 0.5) << joint << " " << seed;
    }
  }
  EXPECT_LT(farthest_m, 0.5e-3) << "in a second";
}

TEST(JointPlausibility, AJointThatSeemsToHaveNoWeightAtTheStartIsNoticed) {
  for (const char* name : {"slave-keops", "vertical"}) {
    for (const int joint : {0, 1, 2}) {
      Watched robot(name, 0.1, 5);
      robot.stand_still();
      std::optional<double> stuck_m;
      EXPECT_FALSE(robot.run(0.2, {0.0, [&](robot::JointReading& reading) {
                                     if (!stuck_m) stuck_m = reading.joints_m[joint];
                                     reading.joints_m[joint] = *stuck_m;
                                   }}));
      EXPECT_EQ(robot.doubt().kind, Kind::kForce) << name << " " << joint;
      EXPECT_EQ(robot.doubt().joint, joint) << name;
      EXPECT_LT(robot.time_s(), 0.03) << name << " " << joint;
    }
  }
}

TEST(JointPlausibility, ARobotWithoutWeightIsBelieved) {
  for (const char* name : {"slave-keops", "master-horizontal", "vertical", "asymmetric"}) {
    Watched robot(name, 0.3, 2, true);
    EXPECT_TRUE(robot.run(3.0)) << name << " " << robot.doubt().value;
    EXPECT_EQ(robot.doubted_s(), 1e9) << name;
  }
}

TEST(JointPlausibility, ARobotThatStandsStillIsBelieved) {
  for (const char* name : {"slave-keops", "master-horizontal", "vertical", "asymmetric"}) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      Watched robot(name, 0.3, seed);
      robot.stand_still();
      EXPECT_TRUE(robot.run(10.0)) << name << " " << seed << " " << robot.doubt().value;
      EXPECT_EQ(robot.doubted_s(), 1e9) << name << " " << seed;
    }
  }
}

TEST(JointPlausibility, OneWildReadingIsLeftOut) {
  Watched robot("slave-keops", 0.1, 5);
  int left = 1;
  EXPECT_TRUE(robot.run(3.0, {2.0, [&](robot::JointReading& reading) {
                                if (left-- > 0) reading.joints_m[1] += 1e-3;
                              }}));
  EXPECT_NEAR(robot.doubted_s(), 2.0, 1e-6);
  EXPECT_LT(robot.off_m(), 25e-6);
}

TEST(JointPlausibility, ASensorThatSticksIsNoticedBeforeTheToolIsAFifthOfAMillimetreOff) {
  for (const int joint : {0, 1, 2}) {
    for (const double at_s : {1.5, 1.9, 2.3, 2.6}) {
      Watched robot("slave-keops", 0.1, 5);
      std::optional<double> stuck_m;
      const bool good = robot.run(at_s + 1.0, {at_s, [&](robot::JointReading& reading) {
                                                 if (!stuck_m) stuck_m = reading.joints_m[joint];
                                                 reading.joints_m[joint] = *stuck_m;
                                               }});
      EXPECT_FALSE(good);
      EXPECT_LT(robot.time_s(), at_s + 0.03) << joint;
      EXPECT_LT(robot.off_m(), 0.2e-3) << joint << " " << at_s;
    }
  }
}

TEST(JointPlausibility, AReadingThatTheDeviceTookLateIsBelieved) {
  Watched robot("slave-keops", 0.1, 5);
  // 10 ms later than it was due, as its own clock says, at 20 mm/s.
  int left = 1;
  EXPECT_TRUE(robot.run(2.5, {2.0, [&](robot::JointReading& reading) {
                                if (left-- <= 0) return;
                                reading.joints_m += Vec3(30e-6, -30e-6, 0.0);
                                reading.time_ns += 10'000'000;
                              }}));
  EXPECT_EQ(robot.doubted_s(), 1e9);
}

TEST(JointPlausibility, NobodyIsJudgedWhoIsNotToBe) {
  const robot::RobotModel model = robot::load_robot("slave-keops");
  JointAccelerationControl control(model, {});
  robot::JointReading reading{.joints_m = Vec3::Constant(0.02), .valid = true};
  control.reset(reading.joints_m);
  for (int n = 0; n < 300; ++n) {
    reading.joints_m[0] += n > 200 ? 1e-3 : 0.0;
    (void)control.observe(reading);
    (void)control.currents(Vec3::Zero());
    EXPECT_TRUE(control.measured());
  }
  EXPECT_FALSE(control.doubt());
}

}  // namespace
}  // namespace telekerf::control
