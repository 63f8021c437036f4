// SPDX-License-Identifier: Apache-2.0
// The emergency stop between real processes: who confirms it, who ends it, and what a restart makes of it.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>

#include "tests/system/programs.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;

std::vector<std::string> in_cell(std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), {"--domain", own_domain(), "--cell", "stopped"});
  return arguments;
}

/// Exit code of telekerf-ctl, and what it said.
std::pair<int, std::string> say(const std::vector<std::string>& what) {
  Program said("telekerf-ctl", in_cell(what));
  const int code = said.wait(seconds(20));
  return {code, said.output()};
}

class Stop : public testing::Test {
 protected:
  void engaged() {
    ASSERT_TRUE(master->says("engaged: the slave follows", seconds(30))) << master->output();
    ASSERT_TRUE(slave->says("beam on", seconds(30))) << slave->output();
  }
  std::unique_ptr<Program> start(const std::string& program, const std::vector<std::string>& more = {}) {
    return std::make_unique<Program>(program, in_cell(more));
  }

  std::unique_ptr<Program> vision = start("telekerf-vision", {"--image", "circle"});
  std::unique_ptr<Program> slave = start("telekerf-slave");
  std::unique_ptr<Program> master = start("telekerf-master", {"--engage"});
};

TEST_F(Stop, IsConfirmedByBothLoopsAndEndedByItsOwnerAlone) {
  engaged();
  const auto [stopped, stop_said] = say({"stop", "--as", "ann", "--reason", "smoke"});
  EXPECT_EQ(stopped, 0) << stop_said;
  EXPECT_NE(stop_said.find("master"), std::string::npos) << stop_said;
  EXPECT_NE(stop_said.find("slave"), std::string::npos) << stop_said;
  EXPECT_TRUE(slave->says("stopped: laser off until clear-stop", seconds(2))) << slave->output();
  EXPECT_TRUE(master->says("stopped", seconds(2))) << master->output();

  const auto [foreign, foreign_said] = say({"clear-stop", "--as", "bob"});
  EXPECT_EQ(foreign, 2) << foreign_said;
  EXPECT_NE(foreign_said.find("ann"), std::string::npos) << foreign_said;
  (void)say({"engage"});
  EXPECT_TRUE(master->says("refused while stopped", seconds(5))) << master->output();

  const auto [cleared, clear_said] = say({"clear-stop", "--as", "ann"});
  EXPECT_EQ(cleared, 0) << clear_said;
  EXPECT_TRUE(master->says("moving to the contour", seconds(5))) << master->output();
  std::this_thread::sleep_for(seconds(4));
  const auto beams = [&] {
    int n = 0;
    const std::string all = slave->output();
    for (std::size_t at = all.find("beam on"); at != std::string::npos; at = all.find("beam on", at + 1)) ++n;
    return n;
  };
  const int before = beams();
  std::this_thread::sleep_for(seconds(2));
  EXPECT_EQ(beams(), before) << "nothing comes back by itself";
  EXPECT_EQ(say({"engage"}).first, 0);
  EXPECT_TRUE([&] {
    for (int n = 0; n < 100 && beams() == before; ++n)
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return beams() > before;
  }()) << slave->output();
}

TEST_F(Stop, SurvivesTheRestartOfEachSideAndOfBoth) {
  engaged();
  EXPECT_EQ(say({"stop"}).first, 0);
  slave->interrupt();
  EXPECT_EQ(slave->wait(seconds(10)), 0);
  slave = start("telekerf-slave", {"--stop-file", "off"});  // it hears it from the master
  EXPECT_TRUE(slave->says("stopped: laser off until clear-stop", seconds(10))) << slave->output();
  master->interrupt();
  EXPECT_EQ(master->wait(seconds(10)), 0);
  master = start("telekerf-master", {"--engage", "--stop-file", "off"});
  EXPECT_TRUE(master->says("stopped", seconds(10))) << master->output();
  master->interrupt();
  EXPECT_EQ(master->wait(seconds(10)), 0);
  slave->interrupt();
  EXPECT_EQ(slave->wait(seconds(10)), 0);
  slave = start("telekerf-slave");  // nobody is there to tell it
  EXPECT_TRUE(slave->says("stopped: laser off until clear-stop", seconds(10))) << slave->output();
  EXPECT_EQ(say({"clear-stop"}).first, 0);
}

/// A foot switch of three states at the port of the master's.
class Foot {
 public:
  Foot() : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    // Any port that is free now.
    there_.sin_family = AF_INET;
    there_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int probe = ::socket(AF_INET, SOCK_DGRAM, 0);
    socklen_t size = sizeof(there_);
    EXPECT_EQ(::bind(probe, reinterpret_cast<sockaddr*>(&there_), size), 0);
    EXPECT_EQ(::getsockname(probe, reinterpret_cast<sockaddr*>(&there_), &size), 0);
    ::close(probe);
    thread_ = std::jthread([this](const std::stop_token& stop) {
      for (; !stop.stop_requested(); std::this_thread::sleep_for(std::chrono::milliseconds(10))) tell();
    });
  }
  ~Foot() {
    thread_ = {};
    ::close(socket_);
  }
  std::string button() const { return "udp:127.0.0.1:" + std::to_string(ntohs(there_.sin_port)); }
  void is(std::uint32_t state) { state_ = state; }

 private:
  void tell() {
    struct {
      std::uint32_t magic = 0x42554b54, version = 1;
      std::uint64_t sequence = 0;
      std::uint32_t held = 0, reserved = 0;
    } told;
    told.sequence = ++sequence_;
    told.held = state_;
    (void)::sendto(socket_, &told, sizeof(told), 0, reinterpret_cast<const sockaddr*>(&there_),
                   sizeof(there_));
  }

  sockaddr_in there_{};
  int socket_;
  std::uint64_t sequence_ = 0;
  std::atomic<std::uint32_t> state_{0};
  std::jthread thread_;
};

TEST_F(Stop, AFootThatSqueezesItsSwitchStopsBothSidesUntilItHasLetGo) {
  constexpr std::uint32_t kReleased = 0, kHeld = 1, kSqueezed = 2;
  Foot foot;
  master->interrupt();
  (void)master->wait(seconds(10));  // it may not have had anything to lead yet
  master = start("telekerf-master", {"--engage", "--button", foot.button()});
  ASSERT_TRUE(master->says("engaged: the slave follows", seconds(30))) << master->output();
  std::this_thread::sleep_for(seconds(1));
  foot.is(kHeld);
  ASSERT_TRUE(slave->says("beam on", seconds(30))) << slave->output();
  foot.is(kSqueezed);
  EXPECT_TRUE(slave->says("stopped: laser off until clear-stop", seconds(2))) << slave->output();
  EXPECT_TRUE(master->says("stopped", seconds(2))) << master->output();
  const auto [foreign, foreign_said] = say({"clear-stop"});
  EXPECT_EQ(foreign, 2) << foreign_said;
  EXPECT_NE(foreign_said.find("the stop was said by foot-switch"), std::string::npos) << foreign_said;

  (void)say({"clear-stop", "--as", "foot-switch"});  // its cause stands
  EXPECT_NE(say({"clear-stop"}).second.find("the stop was said by foot-switch"), std::string::npos)
      << "stopped anew";
  foot.is(kReleased);
  const auto [cleared, clear_said] = say({"clear-stop", "--as", "foot-switch"});
  EXPECT_EQ(cleared, 0) << clear_said;
  EXPECT_TRUE(master->says("moving to the contour", seconds(5))) << master->output();
  EXPECT_NE(say({"clear-stop"}).second.find("no stop is in force"), std::string::npos);
}

TEST(StopOfNobody, IsNoSuccess) {
  const auto [code, said] = say({"stop"});
  EXPECT_EQ(code, 2);
  EXPECT_NE(said.find("nobody listens"), std::string::npos) << said;
}

}  // namespace
}  // namespace telekerf::integration
