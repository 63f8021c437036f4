// SPDX-License-Identifier: Apache-2.0
// The drive of docs/how-to/add-a-drive.md, in Python: the page's rules hold, and a slave takes it for a
// robot.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <optional>
#include <thread>

#include "common/robot/drivers/udp_robot.h"
#include "tests/system/programs.h"

namespace telekerf::integration {
namespace {

using boost::asio::ip::udp;
using robot::UdpCurrents;
using robot::UdpReading;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// docs/how-to/drive_example.py on any free port.
class ExampleDrive : public Program {
 public:
  ExampleDrive() : Program(TELEKERF_PYTHON, {TELEKERF_DRIVE_EXAMPLE, "--port", "0"}) {
    const std::string before = "drive: udp:127.0.0.1:";
    if (!says(before, seconds(20)) || !says("\n", seconds(1))) return;
    port_ = static_cast<std::uint16_t>(std::stoi(output().substr(output().find(before) + before.size())));
  }
  std::uint16_t port() const { return port_; }

 private:
  std::uint16_t port_ = 0;
};

/// Speaks to a drive datagram by datagram.
class Controller {
 public:
  explicit Controller(std::uint16_t port) : drive_(boost::asio::ip::address_v4::loopback(), port) {
    socket_.open(udp::v4());
    socket_.non_blocking(true);
  }
  /// The drive's answer; none within a tenth of a second.
  std::optional<UdpReading> ask(const UdpCurrents& currents, std::size_t size = sizeof(UdpCurrents)) {
    socket_.send_to(boost::asio::buffer(&currents, size), drive_);
    UdpReading reading;
    udp::endpoint from;
    boost::system::error_code error = boost::asio::error::would_block;
    for (int i = 0; i < 100 && error; ++i) {
      std::this_thread::sleep_for(milliseconds(1));
      const auto got = socket_.receive_from(boost::asio::buffer(&reading, sizeof reading), from, 0, error);
      if (!error && got != sizeof reading) return std::nullopt;
    }
    if (error) return std::nullopt;
    return reading;
  }

 private:
  boost::asio::io_context context_;
  udp::socket socket_{context_};
  udp::endpoint drive_;
};

UdpCurrents currents(std::uint64_t sequence, double first_a) {
  UdpCurrents out;
  out.period_ns = 1'000'000;
  out.sequence = sequence;
  out.currents_a[0] = first_a;
  return out;
}

TEST(DriveExample, AnswersAndObeysAsThePageSays) {
  ExampleDrive drive;
  ASSERT_NE(drive.port(), 0) << drive.output();
  Controller controller(drive.port());
  const auto first = controller.ask(currents(1, 0.0));
  ASSERT_TRUE(first);
  EXPECT_EQ(first->magic, UdpReading::kMagic);
  EXPECT_EQ(first->valid, 1u);
  EXPECT_EQ(first->sequence, 1u);
  EXPECT_EQ(first->joints_m[0], 0.02);

  auto last = *first;
  for (std::uint64_t sequence = 2; sequence < 40; ++sequence) {
    const auto next = controller.ask(currents(sequence, 0.2));
    ASSERT_TRUE(next) << sequence;
    EXPECT_EQ(next->sequence, sequence);
    EXPECT_EQ(next->tick, last.tick + 1);
    EXPECT_GE(next->time_ns, last.time_ns);
    EXPECT_GE(next->joints_m[0], last.joints_m[0]) << "a positive current moves a joint its positive way";
    EXPECT_EQ(next->joints_m[1], 0.02);
    last = *next;
  }
  EXPECT_GT(last.joints_m[0], 0.0205);
}

TEST(DriveExample, HearsNoNonsenseNoOldNewsAndNoStranger) {
  ExampleDrive drive;
  ASSERT_NE(drive.port(), 0) << drive.output();
  Controller controller(drive.port());
  ASSERT_TRUE(controller.ask(currents(5, 0.0)));
  EXPECT_FALSE(controller.ask(currents(5, 0.0))) << "twice";
  EXPECT_FALSE(controller.ask(currents(4, 0.0))) << "old";
  EXPECT_FALSE(controller.ask(currents(6, 0.0), sizeof(UdpCurrents) - 1)) << "short";
  UdpCurrents wrong = currents(6, 0.0);
  wrong.magic = UdpReading::kMagic;
  EXPECT_FALSE(controller.ask(wrong));
  EXPECT_FALSE(controller.ask(currents(6, std::nan(""))));
  wrong = currents(6, 0.0);
  wrong.period_ns = 0;
  EXPECT_FALSE(controller.ask(wrong));

  ASSERT_TRUE(controller.ask(currents(6, 0.0)));
  Controller stranger(drive.port());
  EXPECT_FALSE(stranger.ask(currents(100, 0.0)));
  ASSERT_TRUE(controller.ask(currents(7, 0.0)));
  std::this_thread::sleep_for(milliseconds(600));
  EXPECT_TRUE(stranger.ask(currents(1, 0.0))) << "the first one has gone";
}

TEST(DriveExample, SwitchesOffWhenItsControllerFallsSilent) {
  ExampleDrive drive;
  ASSERT_NE(drive.port(), 0) << drive.output();
  Controller controller(drive.port());
  for (std::uint64_t sequence = 1; sequence < 10; ++sequence)
    ASSERT_TRUE(controller.ask(currents(sequence, 0.5)));
  EXPECT_TRUE(drive.says("no currents, motors off", seconds(5)));
  drive.interrupt(SIGTERM);
  EXPECT_EQ(drive.wait(seconds(10)), 0) << drive.output();
  EXPECT_TRUE(drive.says("9 steps", seconds(1))) << drive.output();
}

TEST(DriveExample, IsMeasuredToAnswerOnePeriodLate) {
  // On a machine that lets it wait too often the program refuses to tell, in words, and is asked again.
  std::string said;
  for (int attempt = 0; attempt < 4; ++attempt) {
    ExampleDrive drive;
    ASSERT_NE(drive.port(), 0) << drive.output();
    Program inspect("telekerf-inspect",
                    {"drive", "--drive", "udp:127.0.0.1:" + std::to_string(drive.port()), "--drive-stale-s",
                     "2", "--control-hz", "500", "--travel-mm", "15", "--move"});
    const int code = inspect.wait(seconds(30));
    said = inspect.output();
    if (code == 0) break;
    ASSERT_NE(said.find("its delay cannot be told"), std::string::npos) << said;
  }
  const std::string before = "drive_delay_s = ";
  ASSERT_NE(said.rfind(before), std::string::npos) << said;
  const double delay_s = std::stod(said.substr(said.rfind(before) + before.size()));
  EXPECT_NEAR(delay_s, 2e-3, 4e-4) << said;
}

TEST(DriveExample, ASlaveTakesItForARobotAndHoldsIt) {
  ExampleDrive drive;
  ASSERT_NE(drive.port(), 0) << drive.output();
  const auto out = Program::scratch() / "python";
  Program slave("telekerf-slave",
                {"--domain", own_domain(), "--cell", "python", "--record", out.string(), "--drive",
                 "udp:127.0.0.1:" + std::to_string(drive.port()), "--drive-stale-s", "2"});
  ASSERT_TRUE(slave.says("ready in python", seconds(20))) << slave.output();
  std::this_thread::sleep_for(seconds(3));
  ASSERT_TRUE(slave.running()) << slave.output();
  slave.interrupt();
  EXPECT_EQ(slave.wait(seconds(20)), 0) << slave.output();
  std::ifstream record(out / "slave.csv");
  const auto rows = std::count(std::istreambuf_iterator<char>(record), {}, '\n');
  EXPECT_GT(rows, 1000) << "a row a step";
  EXPECT_TRUE(drive.says("no currents, motors off", seconds(5))) << "the slave has gone";
}

}  // namespace
}  // namespace telekerf::integration
