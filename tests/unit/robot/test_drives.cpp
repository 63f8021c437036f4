// SPDX-License-Identifier: Apache-2.0
// The choice of a drive, and the watch over whatever was chosen.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "common/robot/drivers/simulated_robot.h"
#include "common/robot/supervisor.h"
#include "common/runtime/startup_error.h"

namespace telekerf::robot {
namespace {

TEST(Drives, WhatIsNoDriveIsRefusedWithWhatItMustBe) {
  for (const char* wrong : {"", "Simulated", "ethercat", "ethercat:0", ":7000"}) {
    EXPECT_NE(validate_drive(wrong).find("must be one of simulated, udp:HOST:PORT"), std::string::npos)
        << wrong;
  }
  EXPECT_EQ(validate_drive("simulated:2"), "stands alone, nothing follows its name");
  for (const char* wrong : {"udp", "udp:", "udp:7000", "udp::7000", "udp:host", "udp:host:", "udp:host:0",
                            "udp:host:65536", "udp:host:-1", "udp:host:7000x", "udp:host:1e3"}) {
    EXPECT_NE(validate_drive(wrong).find("within [1, 65535], as in udp:127.0.0.1:7000"), std::string::npos)
        << wrong;
  }
  for (const char* right : {"simulated", "udp:127.0.0.1:7000", "udp:robot.local:1", "udp:host:65535"}) {
    EXPECT_EQ(validate_drive(right), "") << right;
  }
}

TEST(Drives, OnlyWhatIsSimulatedHereHasAPlant) {
  const RobotModel model = load_robot("slave-keops");
  const Drive simulated = open_drive("simulated", {model, 1000.0, {}});
  EXPECT_EQ(simulated.plant, simulated.robot.get());
  EXPECT_EQ(open_drive("udp:127.0.0.1:9", {model, 1000.0, {}}).plant, nullptr);
  try {
    (void)open_drive("udp:127.0.0.1:99999", {model, 1000.0, {}});
    FAIL() << "accepted";
  } catch (const StartupError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("drive = udp:127.0.0.1:99999: "), std::string::npos);
  }
}

/// Tells what it is told to; remembers what it got.
class Scripted : public Robot {
 public:
  struct Told {
    std::vector<JointReading> readings;  ///< one a call; afterwards there is none
    std::vector<Vec3> written_a;
    double max_rate_hz = 1000.0;
  };
  explicit Scripted(Told& told) : told_(told) {}
  JointReading read() noexcept override {
    return next_ < told_.readings.size() ? told_.readings[next_++] : JointReading{};
  }
  void write(const Vec3& currents_a) noexcept override { told_.written_a.push_back(currents_a); }
  Capabilities capabilities() const override { return {"scripted", false, 0, 0, told_.max_rate_hz}; }

 private:
  Told& told_;
  std::size_t next_ = 0;
};

JointReading reading(std::uint64_t tick, double joint_m = 0.02) {
  return {Vec3::Constant(joint_m), true, tick, 0};
}

class Watched : public testing::Test {
 protected:
  std::unique_ptr<RobotSupervisor> machine() {
    RobotSupervisorSettings settings;
    settings.drive = "scripted";
    settings.drive_stale_s = stale_s;
    return std::make_unique<RobotSupervisor>(load_robot("slave-keops"), settings, 1000.0,
                                             Drive{std::make_unique<Scripted>(told), nullptr});
  }
  Scripted::Told told;
  const Vec3 current_a = Vec3(1, -2, 3);
  double stale_s = 0.003;
};

TEST_F(Watched, HasNoCurrentWhileItHasNotBeenSeenForFiftyMillisecondsHoweverPatientOneIs) {
  stale_s = 0.5;
  told.readings = {reading(1), reading(2)};
  told.readings.resize(2 + 100);
  told.readings.push_back(reading(3));
  const auto robot = machine();
  EXPECT_TRUE(robot->read().valid);
  robot->write(current_a);
  for (int missing = 1; missing <= 100; ++missing) {
    EXPECT_FALSE(robot->read().valid);
    robot->write(current_a);
    ASSERT_EQ(told.written_a.back(), missing < 50 ? current_a : Vec3(Vec3::Zero())) << missing;
  }
  EXPECT_FALSE(robot->failed());
  EXPECT_TRUE(robot->read().valid);
  robot->write(current_a);
  EXPECT_EQ(told.written_a.back(), current_a);
}

TEST_F(Watched, HasNoCurrentBeforeTheLoopsFirstReadingNorAfterTheEnd) {
  told.readings = {{}, {}, reading(1), {}, reading(2)};
  {
    const auto robot = machine();  // waits for the first reading
    EXPECT_FALSE(robot->started());
    EXPECT_FALSE(robot->read().valid);
    robot->write(current_a);
    for (const Vec3& written : told.written_a) EXPECT_EQ(written, Vec3::Zero());
    EXPECT_TRUE(robot->read().valid);
    EXPECT_TRUE(robot->started());
    robot->write(current_a);
    EXPECT_EQ(told.written_a.back(), current_a);
    robot->release();
    EXPECT_EQ(told.written_a.back(), Vec3::Zero());
    robot->write(current_a);
  }
  EXPECT_EQ(told.written_a.back(), Vec3::Zero());
}

TEST_F(Watched, TakesNoReadingTwice) {
  told.readings = {reading(1), reading(1), reading(2), reading(2), reading(3)};
  const auto robot = machine();  // takes the first one
  EXPECT_FALSE(robot->read().valid);
  EXPECT_TRUE(robot->read().valid);
  EXPECT_FALSE(robot->read().valid);
  EXPECT_TRUE(robot->read().valid);
  EXPECT_EQ(robot->readings_missed(), 2u);
  EXPECT_FALSE(robot->failed());
}

TEST_F(Watched, AReadingThatIsNotFiniteIsAFaultForGood) {
  using Numbers = std::numeric_limits<double>;
  for (const double nonsense : {Numbers::quiet_NaN(), Numbers::infinity(), -Numbers::infinity()}) {
    for (int joint = 0; joint < 3; ++joint) {
      JointReading wrong = reading(3);
      wrong.joints_m[joint] = nonsense;
      told = {};
      told.readings = {reading(1), reading(2), wrong, reading(4), reading(5)};
      const auto robot = machine();
      EXPECT_TRUE(robot->read().valid);
      robot->write(current_a);
      EXPECT_EQ(told.written_a.back(), current_a);
      for (int n = 0; n < 3; ++n) {
        EXPECT_FALSE(robot->read().valid) << n;
        EXPECT_TRUE(robot->failed()) << n;
        robot->write(current_a);
        EXPECT_EQ(told.written_a.back(), Vec3::Zero()) << n;
      }
      const std::string said =
          fmt::format("joint {} is read at {} m, which is no place", joint + 1, nonsense);
      EXPECT_NE(robot->failure().find(said), std::string::npos) << robot->failure();
    }
  }
}

TEST_F(Watched, ARobotWhoseFirstReadingIsNotFiniteIsRefusedWithThatSentence) {
  told.readings = {reading(1, std::numeric_limits<double>::quiet_NaN())};
  try {
    (void)machine();
    FAIL() << "accepted";
  } catch (const StartupError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("joint 1 is read at nan m"), std::string::npos)
        << refusal.what();
  }
}

TEST_F(Watched, IsLostForGoodAfterItsPatience) {
  told.readings = {reading(1), reading(2), {}, {}, reading(3), {}, {}, {}, reading(4)};
  const auto robot = machine();
  EXPECT_TRUE(robot->read().valid);
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(robot->read().valid);
  EXPECT_TRUE(robot->read().valid);  // two steps are bridged
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(robot->failed()) << i;
    EXPECT_FALSE(robot->read().valid);
    robot->write(current_a);
    EXPECT_EQ(told.written_a.back(), i < 2 ? current_a : Vec3(Vec3::Zero())) << i;
  }
  EXPECT_TRUE(robot->failed());
  EXPECT_FALSE(robot->read().valid) << "it does not come back by itself";
  robot->write(current_a);
  EXPECT_EQ(told.written_a.back(), Vec3::Zero());
  EXPECT_NE(robot->failure().find("drive = scripted: no reading for 0.003 s (drive_stale_s)"),
            std::string::npos);
}

TEST_F(Watched, TellsNoTruthThatNobodyKnows) {
  told.readings = {reading(1)};
  const auto robot = machine();
  EXPECT_EQ(robot->plant(), nullptr);
  EXPECT_FALSE(robot->true_tool_m().has_value());
  EXPECT_FALSE(robot->true_tool_velocity_m_per_s().has_value());
}

TEST_F(Watched, MustStandWhereItsFileHasAPose) {
  told.readings = {reading(1, 0.2)};
  try {
    (void)machine();
    FAIL() << "accepted";
  } catch (const StartupError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("leg 1 is out of stroke: 0.2 m is beyond its end"),
              std::string::npos)
        << refusal.what();
  }
  for (const Vec3& written : told.written_a) EXPECT_EQ(written, Vec3::Zero());
}

TEST_F(Watched, MustKeepUpWithTheController) {
  told.max_rate_hz = 500.0;
  try {
    (void)machine();
    FAIL() << "accepted";
  } catch (const StartupError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("at most 500 steps a second, the controller makes 1000"),
              std::string::npos)
        << refusal.what();
  }
}

TEST(RobotSupervisor, ASimulatedRobotThatRanOffHasFailedToo) {
  const RobotModel model = load_robot("slave-keops");
  RobotSupervisor robot(model, {}, 1000.0, open_drive("simulated", {model, 1000.0, {}}));
  EXPECT_TRUE(robot.read().valid);
  robot.plant()->set_tool_force({1e6, 0, 0});
  for (int i = 0; i < 1000 && !robot.failed(); ++i) {
    robot.write(Vec3::Zero());
    robot.advance();
    (void)robot.read();
  }
  EXPECT_TRUE(robot.failed());
  EXPECT_NE(robot.failure().find("left the poses"), std::string::npos);
}

}  // namespace
}  // namespace telekerf::robot
