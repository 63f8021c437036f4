// SPDX-License-Identifier: Apache-2.0
// The hardware seam with a robot in another process: the controller below knows nothing but `Robot`.
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <thread>
#include <vector>

#include "common/control/joint_acceleration_control.h"
#include "common/robot/drivers/simulated_robot.h"
#include "common/robot/drivers/udp_robot.h"
#include "common/runtime/startup_error.h"

namespace telekerf::robot {
namespace {

constexpr double kPeriod_s = 1e-3;

/// Forks a process that is the drive of `model`, resting in its workspace's centre; ends it when destroyed.
class DriveProcess {
 public:
  explicit DriveProcess(const RobotModel& model) {
    int ends[2];
    if (pipe(ends) != 0) throw environment_error("no pipe");
    pid_ = fork();
    if (pid_ == 0) {
      SimulatedRobot plant(model, 3, model.workspace.centre_m);
      UdpDrive drive(plant, 0);
      const std::uint16_t port = drive.port();
      const bool told = write(ends[1], &port, sizeof(port)) == sizeof(port);
      if (told) drive.serve_for(60);
      _exit(0);
    }
    pollfd wait{ends[0], POLLIN, 0};
    if (poll(&wait, 1, 20000) != 1 || read(ends[0], &port_, sizeof(port_)) != sizeof(port_)) port_ = 0;
    close(ends[0]);
    close(ends[1]);
  }
  ~DriveProcess() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  DriveProcess(const DriveProcess&) = delete;
  DriveProcess& operator=(const DriveProcess&) = delete;

  std::uint16_t port() const { return port_; }

 private:
  pid_t pid_ = -1;
  std::uint16_t port_ = 0;
};

/// Holds the tool at `goal` (base frame) for `steps` steps through any robot; returns the last measured tool.
Vec3 hold(Robot& robot, const RobotModel& model, const Vec3& goal, int steps) {
  const DeltaKinematics kinematics(model.geometry);
  control::JointAccelerationControl control(model, {.observer = {kPeriod_s, 200, 600}});
  control.reset(*kinematics.inverse(model.workspace.centre_m));
  Vec3 tool = model.workspace.centre_m;
  for (int i = 0; i < steps; ++i) {
    JointReading reading = robot.read();
    for (int wait = 0; wait < 200 && i > 0 && !reading.valid; ++wait) {
      std::this_thread::sleep_for(std::chrono::microseconds(50));
      reading = robot.read();
    }
    if (!control.observe(reading)) return Vec3::Zero();
    tool = control.state().tool_m;
    const Vec3 wanted = 2500 * (goal - tool) - 100 * control.state().tool_velocity_m_per_s;
    robot.write(control.currents(control.state().joint_acceleration(wanted)));
  }
  return tool;
}

TEST(UdpRobot, ARobotInAnotherProcessIsControlledLikeAnyOther) {
  const RobotModel model = load_robot("slave-keops");
  const DriveProcess process(model);
  ASSERT_NE(process.port(), 0);
  UdpRobot robot({"127.0.0.1", process.port()}, kPeriod_s);
  const Vec3 goal = model.workspace.centre_m + Vec3(0.005, -0.003, 0.001);
  const Vec3 tool = hold(robot, model, goal, 1500);
  EXPECT_LT((tool - goal).norm(), 20e-6);
  EXPECT_EQ(robot.dropped(), 0u);
}

TEST(UdpRobot, NothingThereIsAnInvalidReadingNotAWait) {
  UdpRobot robot({"127.0.0.1", 9}, kPeriod_s);  // nobody answers
  for (int i = 0; i < 10; ++i) {
    robot.write(Vec3::Zero());
    EXPECT_FALSE(robot.read().valid);
  }
  EXPECT_THROW(UdpRobot({"no.such.host.invalid", 9}, kPeriod_s), StartupError);
}

TEST(UdpRobot, StrangersAreNotTakenAndNothingIsReadTwice) {
  const RobotModel model = load_robot("slave-keops");
  SimulatedRobot plant(model, 3, model.workspace.centre_m);
  UdpDrive drive(plant, 0);
  UdpRobot robot({"127.0.0.1", drive.port()}, kPeriod_s);
  boost::asio::io_context context;
  boost::asio::ip::udp::socket stranger(context, boost::asio::ip::udp::v4());
  const std::string nonsense(40, 'x');
  stranger.send_to(boost::asio::buffer(nonsense), {boost::asio::ip::address_v4::loopback(), drive.port()});
  robot.write(Vec3::Zero());
  EXPECT_EQ(drive.serve_for(0.05), 1u);  // the nonsense moved nothing
  const JointReading reading = robot.read();
  EXPECT_TRUE(reading.valid);
  EXPECT_LT((reading.joints_m - plant.true_state().joints_m).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_FALSE(robot.read().valid);  // nothing new
}

TEST(UdpRobot, ADriveWithAKeyObeysWhoHasItAndNobodyElse) {
  const auto folder =
      std::filesystem::path(testing::TempDir()) / ("telekerf-drive-key-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const auto key = [&](const std::string& name, char digit) {
    std::ofstream(folder / name) << std::string(64, digit) << '\n';
    std::filesystem::permissions(folder / name, std::filesystem::perms(0600));
    return (folder / name).string();
  };
  const std::string good = key("good", 'a'), other = key("other", 'b');
  const RobotModel model = load_robot("slave-keops");
  SimulatedRobot plant(model, 3, model.workspace.centre_m);
  UdpDrive drive(plant, 0, good);
  for (const std::string& wrong : {other, std::string()}) {
    UdpRobot stranger({"127.0.0.1", drive.port(), wrong}, kPeriod_s);
    stranger.write(Vec3::Zero());
    EXPECT_EQ(drive.serve_for(0.05), 0u);
    EXPECT_FALSE(stranger.read().valid);
  }
  UdpRobot robot({"127.0.0.1", drive.port(), good}, kPeriod_s);
  robot.write(Vec3::Zero());
  EXPECT_EQ(drive.serve_for(0.05), 1u);
  EXPECT_TRUE(robot.read().valid);
  std::filesystem::remove_all(folder);
}

/// Bytes of `datagram`, sealed if there is a key, with `more` octets behind them.
template <class Datagram>
std::vector<std::byte> sent(const Datagram& datagram, const DatagramSeal& seal, std::size_t more = 0) {
  DatagramSeal::Sealed<Datagram> sealed{datagram};
  const std::size_t size = seal.close(sealed);
  const auto bytes = std::as_bytes(std::span(&sealed, 1)).first(size);
  std::vector<std::byte> whole(bytes.begin(), bytes.end());
  whole.resize(size + more);
  return whole;
}

TEST(UdpRobot, WhatIsLongerOrNoNumberIsRefusedSealedOrNot) {
  namespace asio = boost::asio;
  using asio::ip::udp;
  const auto file =
      std::filesystem::path(testing::TempDir()) / ("telekerf-refused-" + std::to_string(::getpid()));
  std::ofstream(file) << std::string(64, 'a') << '\n';
  std::filesystem::permissions(file, std::filesystem::perms(0600));
  const RobotModel model = load_robot("slave-keops");
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinite = std::numeric_limits<double>::infinity();
  for (const std::string& key : {std::string(), file.string()}) {
    const DatagramSeal seal(key);
    asio::io_context context;
    udp::socket other(context, {asio::ip::address_v4::loopback(), 0});

    SimulatedRobot plant(model, 3, model.workspace.centre_m);
    UdpDrive drive(plant, 0, key);
    const udp::endpoint there(asio::ip::address_v4::loopback(), drive.port());
    UdpCurrents currents;
    currents.period_ns = 1'000'000;
    const auto obeyed = [&](double current_a, std::size_t more) {
      ++currents.sequence;
      currents.currents_a[1] = current_a;
      other.send_to(asio::buffer(sent(currents, seal, more)), there);
      return drive.serve_for(0.02);
    };
    EXPECT_EQ(obeyed(0.0, 0), 1u);
    std::uint64_t refused = 0;
    for (const double bad : {nan, infinite, -infinite}) {
      EXPECT_EQ(obeyed(bad, 0), 0u) << bad;
      EXPECT_EQ(drive.refused(), ++refused);
    }
    for (const std::size_t more : {1u, 2u, 15u, 16u, 17u, 60000u}) {
      EXPECT_EQ(obeyed(0.0, more), 0u) << more;
      EXPECT_EQ(drive.refused(), ++refused);
    }
    EXPECT_TRUE(plant.true_state().joints_m.allFinite());
    EXPECT_EQ(obeyed(0.0, 0), 1u);

    UdpRobot robot({"127.0.0.1", other.local_endpoint().port(), key}, kPeriod_s);
    UdpReading reading;
    reading.valid = 1;
    udp::endpoint controller;
    const auto read = [&](double joint_m, std::size_t more, std::uint64_t ahead = 0) {
      robot.write(Vec3::Zero());
      std::array<char, 200> taken{};
      do other.receive_from(asio::buffer(taken), controller);
      while (controller == there);  // the drive's answers of before
      reading.sequence = ++reading.tick + ahead;
      reading.joints_m[2] = joint_m;
      other.send_to(asio::buffer(sent(reading, seal, more)), controller);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      return robot.read().valid;
    };
    EXPECT_TRUE(read(0.01, 0));
    refused = 0;
    for (const double bad : {nan, infinite, -infinite}) {
      EXPECT_FALSE(read(bad, 0)) << bad;
      EXPECT_EQ(robot.refused(), ++refused);
    }
    for (const std::size_t more : {1u, 16u, 60000u}) {
      EXPECT_FALSE(read(0.01, more)) << more;
      EXPECT_EQ(robot.refused(), ++refused);
    }
    EXPECT_FALSE(read(0.01, 0, 1000)) << "an answer to what was never asked";
    EXPECT_EQ(robot.refused(), ++refused);
    EXPECT_TRUE(read(0.01, 0));
    EXPECT_EQ(robot.dropped(), 0u);
  }
  std::filesystem::remove(file);
}

/// A drive whose answers the test gives itself.
class HandDrive {
 public:
  HandDrive() : socket_(context_, {boost::asio::ip::address_v4::loopback(), 0}) {}
  std::uint16_t port() const { return socket_.local_endpoint().port(); }
  /// Takes one datagram of currents; its sequence.
  std::uint64_t take() {
    UdpCurrents currents;
    socket_.receive_from(boost::asio::buffer(&currents, sizeof currents), controller_);
    return currents.sequence;
  }
  void answer(std::uint64_t sequence) {
    UdpReading reading;
    reading.valid = 1;
    reading.sequence = reading.tick = sequence;
    for (double& joint : reading.joints_m) joint = 1e-3 * static_cast<double>(sequence);
    socket_.send_to(boost::asio::buffer(&reading, sizeof reading), controller_);
  }

 private:
  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint controller_;
};

TEST(UdpRobot, AnAnswerLaterThanUsualIsNone) {
  HandDrive drive;
  UdpRobot robot({"127.0.0.1", drive.port()}, kPeriod_s);
  const auto read_after = [&](std::initializer_list<std::uint64_t> answers) {
    for (const auto sequence : answers) drive.answer(sequence);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return robot.read();
  };
  std::uint64_t sequence = 0;
  const auto write = [&] {
    robot.write(Vec3::Zero());
    sequence = drive.take();
  };
  write();
  EXPECT_TRUE(read_after({sequence}).valid);
  for (int i = 0; i < 4; ++i) write();  // nothing comes meanwhile
  EXPECT_FALSE(read_after({sequence - 2}).valid) << "two steps old, while it works off what piled up";
  const JointReading newest = read_after({sequence - 1, sequence});
  EXPECT_TRUE(newest.valid);
  EXPECT_EQ(newest.joints_m[0], 1e-3 * static_cast<double>(sequence));
  // A way that takes a step longer from now on.
  int taken = 0;
  for (int i = 0; i < 20; ++i) {
    write();
    taken += read_after({sequence - 1}).valid ? 1 : 0;
  }
  EXPECT_GE(taken, 11);
  write();
  EXPECT_TRUE(read_after({sequence}).valid) << "and soon again";
  write();
  EXPECT_FALSE(read_after({sequence - 1}).valid);
}

TEST(UdpRobot, AnAnswerThatIsTooOldForAnyLoopIsNoneHoweverUsual) {
  for (const double period_s : {1e-3, 5e-3}) {
    HandDrive drive;
    UdpRobot robot({"127.0.0.1", drive.port()}, period_s);
    std::uint64_t sequence = 0;
    const auto taken_at = [&](std::uint64_t lag) {
      int taken = 0;
      for (int i = 0; i < 20; ++i) {
        robot.write(Vec3::Zero());
        sequence = drive.take();
        if (sequence <= lag) continue;
        drive.answer(sequence - lag);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        taken += robot.read().valid ? 1 : 0;
      }
      return taken;
    };
    for (int i = 0; i < 20; ++i) {
      robot.write(Vec3::Zero());
      sequence = drive.take();
    }
    const std::uint64_t most = period_s < 2e-3 ? 10 : 4;
    EXPECT_GT(taken_at(most), 10) << period_s;
    EXPECT_EQ(taken_at(most + 1), 0) << period_s;
  }
}

TEST(UdpRobot, ADriveObeysOneControllerUntilThatHasGone) {
  const RobotModel model = load_robot("slave-keops");
  SimulatedRobot plant(model, 3, model.workspace.centre_m);
  UdpDrive drive(plant, 0);
  UdpRobot first({"127.0.0.1", drive.port()}, kPeriod_s);
  UdpRobot second({"127.0.0.1", drive.port()}, kPeriod_s);
  first.write(Vec3::Zero());
  EXPECT_EQ(drive.serve_for(0.05), 1u);
  second.write(Vec3::Constant(1.0));
  EXPECT_EQ(drive.serve_for(0.05), 0u);
  EXPECT_FALSE(second.read().valid);
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  second.write(Vec3::Zero());
  EXPECT_EQ(drive.serve_for(0.05), 1u);
  EXPECT_TRUE(second.read().valid);
  first.write(Vec3::Constant(1.0));
  EXPECT_EQ(drive.serve_for(0.05), 0u);
}

}  // namespace
}  // namespace telekerf::robot
