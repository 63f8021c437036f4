// SPDX-License-Identifier: Apache-2.0
// The emulated link between two network namespaces, beside a veth pair in the same run: nothing early,
// nothing lost that the profile does not lose, little added. Needs root or user namespaces; skipped with the
// reason otherwise.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <thread>

#include "netem/core/emulator.h"
#include "netem/core/trace.h"
#include "tests/system/namespaces.h"

namespace telekerf::integration {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr std::uint16_t kPort = 9000;
constexpr const char* kOverVeth = "10.78.0.2";
constexpr const char* kOverLink = "10.77.0.2";

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double at(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

int udp_socket() {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int bytes = 4 << 20;
  (void)::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof(bytes));
  return fd;
}

sockaddr_in address(const char* host) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(kPort);
  (void)::inet_pton(AF_INET, host, &to.sin_addr);
  return to;
}

/// Sends every datagram back to where it came from, until it is killed.
[[noreturn]] void echo_for_ever() {
  const int fd = udp_socket();
  const sockaddr_in here = address("0.0.0.0");
  (void)::bind(fd, reinterpret_cast<const sockaddr*>(&here), sizeof(here));
  for (;;) {
    char buffer[2048];
    sockaddr_in from{};
    socklen_t length = sizeof(from);
    const ssize_t size =
        ::recvfrom(fd, buffer, sizeof(buffer), 0, reinterpret_cast<sockaddr*>(&from), &length);
    if (size > 0)
      (void)::sendto(fd, buffer, static_cast<std::size_t>(size), 0, reinterpret_cast<sockaddr*>(&from),
                     length);
  }
}

/// Round trips of single datagrams, ms; a lost one counts as infinite.
std::vector<double> round_trips(const char* host, int count, milliseconds patience) {
  const int fd = udp_socket();
  const sockaddr_in to = address(host);
  std::vector<double> rtt_ms;
  for (int i = 0; i < count; ++i) {
    const auto start = Clock::now();
    (void)::sendto(fd, &i, sizeof(i), 0, reinterpret_cast<const sockaddr*>(&to), sizeof(to));
    double measured = std::numeric_limits<double>::infinity();
    pollfd ready{fd, POLLIN, 0};
    while (ms_since(start) < static_cast<double>(patience.count()) && ::poll(&ready, 1, 50) >= 0) {
      int answer = -1;
      if (ready.revents != 0 && ::recv(fd, &answer, sizeof(answer), MSG_DONTWAIT) == sizeof(answer) &&
          answer == i) {
        measured = ms_since(start);
        break;
      }
    }
    rtt_ms.push_back(measured);
  }
  ::close(fd);
  return rtt_ms;
}

/// The two namespaces, joined by a veth pair and by the link under test; an echo on the slave's side.
class NetemLink : public testing::Test {
 protected:
  void SetUp() override {
    Namespaces& both = Namespaces::instance();
    if (!both.obstacle().empty()) GTEST_SKIP() << both.obstacle();
    static const bool joined =
        std::system(
            "ip link add ve0 type veth peer name ve1 && ip addr add 10.78.0.1/24 dev ve0"
            " && ip link set ve0 up") == 0 &&
        move_to_slave("ve1") && both.in_slave("ip addr add 10.78.0.2/24 dev ve1 && ip link set ve1 up");
    if (!joined) GTEST_SKIP() << "a veth pair cannot be made here";
    echo_ = both.fork_on(Side::kSlave, echo_for_ever);
  }
  void TearDown() override {
    if (echo_ <= 0) return;
    ::kill(echo_, SIGKILL);
    ::waitpid(echo_, nullptr, 0);
  }

  void start_link(const std::string& profile, const std::vector<std::string>& more = {}) {
    std::vector<std::string> command = {TELEKERF_NETEM, "link", profile, "--slave-netns",
                                        Namespaces::instance().slave_path()};
    command.insert(command.end(), more.begin(), more.end());
    link_ = std::make_unique<SidedProgram>(
        Side::kOperator, command, testing::TempDir() + "netem-link-" + std::to_string(::getpid()) + ".txt");
    ASSERT_TRUE(link_->says("link up", std::chrono::seconds(10))) << link_->output();
    // The echo may still be starting.
    for (int i = 0; i < 20; ++i) {
      if (round_trips(kOverLink, 1, milliseconds(700)).front() < 1e9) return;
    }
    FAIL() << "no answer over the link";
  }
  /// The profile's file once more; until it says so.
  bool reload(const std::string& said) {
    const std::string before = link_->output();
    link_->reload();
    const auto end = Clock::now() + std::chrono::seconds(5);
    while (Clock::now() < end) {
      if (link_->output().find(said, before.size()) != std::string::npos) return true;
      std::this_thread::sleep_for(milliseconds(10));
    }
    return false;
  }
  /// Its exit code; prints its report.
  int stop_link() {
    link_->interrupt();
    const int code = link_->wait(std::chrono::seconds(10));
    std::printf("%s", link_->output().c_str());
    return code;
  }

 private:
  static bool move_to_slave(const std::string& device) {
    const std::string path = Namespaces::instance().slave_path();
    const std::string pid = path.substr(6, path.find('/', 6) - 6);
    return std::system(("ip link set " + device + " netns " + pid).c_str()) == 0;
  }

  std::unique_ptr<SidedProgram> link_;
  pid_t echo_ = 0;
};

TEST_F(NetemLink, AddsTheProfileAndNothingEarlier) {
  start_link("thesis-constant");
  const auto rtt_ms = round_trips(kOverLink, 60, milliseconds(3000));
  std::printf("thesis-constant: RTT min %.3f median %.3f max %.3f ms\n", at(rtt_ms, 0), at(rtt_ms, 0.5),
              at(rtt_ms, 1));
  for (const double rtt : rtt_ms) EXPECT_GE(rtt, 100.0);
  EXPECT_LT(at(rtt_ms, 1), 1e9) << "lost";
  EXPECT_NEAR(at(rtt_ms, 0.5), 100.0, 10.0);
  EXPECT_EQ(stop_link(), 0);
}

TEST_F(NetemLink, GivesEveryPacketTheFateOfVirtualTime) {
  // In free order a packet's fate depends on its number and on the time since the one before alone, so two
  // drivers with one seed must agree to the nanosecond.
  const std::string folder = testing::TempDir() + "netem-fates-" + std::to_string(::getpid());
  std::filesystem::create_directories(folder);
  const std::string file = folder + "/profile.toml";
  std::ofstream(file) << "[both]\ndelay_ms = 8\njitter_ms = 3\ndistribution = \"gamma\"\nshape = "
                         "2\ncorrelation_ms = 1.442695\n"
                         "order = \"free\"\nloss_model = \"gilbert-elliott\"\nloss = 0.1\nloss_burst_ms = 3\n"
                         "duplicate = 0.05\ncorrupt = 0.05\n";
  start_link(file, {"--seed", "11", "--record", folder});
  round_trips(kOverLink, 200, milliseconds(40));
  stop_link();
  const netem::Recording seen = netem::load_recording(folder + "/forward.csv");
  ASSERT_GE(seen.size(), 200U);
  netem::Emulator expected(netem::load_profile(file).forward, {11}, {1U << 16, 0, 0});
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const netem::PacketOutcome fate = expected.push(seen[i].in_ns, 100U, i);
    ASSERT_EQ(seen[i].lost, fate.lost()) << i;
    if (fate.lost()) continue;
    EXPECT_EQ(seen[i].delay_ns, fate.due_ns - seen[i].in_ns) << i;
    EXPECT_EQ(seen[i].duplicated, fate.duplicated) << i;
    EXPECT_EQ(seen[i].corrupted, fate.corrupted) << i;
  }
  std::filesystem::remove_all(folder);
}

TEST_F(NetemLink, WhatWaitsLeavesAtTheRateOfTheProfileThatTakesOver) {
  const std::string file = testing::TempDir() + "netem-switch-" + std::to_string(::getpid()) + ".toml";
  const auto write = [&](int kbit_per_s) {
    std::ofstream(file) << "[both]\nrate_kbit_per_s = " << kbit_per_s << "\nqueue_bytes = 20000\n";
  };
  write(10'000);
  start_link(file);
  write(1);
  ASSERT_TRUE(reload("switched"));
  const int fd = udp_socket();
  const sockaddr_in to = address(kOverLink);
  const std::vector<char> packet(1000);  // 8 s at 1 kbit/s
  for (int i = 0; i < 5; ++i)
    (void)::sendto(fd, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof(to));
  pollfd ready{fd, POLLIN, 0};
  EXPECT_EQ(::poll(&ready, 1, 300), 0);
  write(10'000);
  const auto start = Clock::now();
  ASSERT_TRUE(reload("switched"));
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(::poll(&ready, 1, 4000), 1) << i;
    char answer[2048];
    EXPECT_EQ(::recv(fd, answer, sizeof(answer), MSG_DONTWAIT), 1000) << i;
  }
  EXPECT_LT(ms_since(start), 4000.0) << "the first was to leave after 8 s";
  ::close(fd);
  EXPECT_EQ(stop_link(), 0);
}

TEST_F(NetemLink, AddsLittleToAVethPair) {
  start_link("ideal");
  // In short windows by turns, more of them where none was quiet: what else the machine does hits both, and a quiet
  // window shows the link's own cost.
  double least = 1e9;
  std::vector<double> veth_ms;
  std::vector<double> link_ms;
  for (int window = 0; window < 20 || (least > 0.2 && window < 100); ++window) {
    const auto veth = round_trips(kOverVeth, 100, milliseconds(1000));
    const auto link = round_trips(kOverLink, 100, milliseconds(1000));
    least = std::min(least, at(link, 0.5) - at(veth, 0.5));
    veth_ms.insert(veth_ms.end(), veth.begin(), veth.end());
    link_ms.insert(link_ms.end(), link.begin(), link.end());
  }
  std::printf(
      "RTT p50 / p99 / max: veth %.3f / %.3f / %.3f ms, link %.3f / %.3f / %.3f ms; least added %.3f ms\n",
      at(veth_ms, 0.5), at(veth_ms, 0.99), at(veth_ms, 1), at(link_ms, 0.5), at(link_ms, 0.99),
      at(link_ms, 1), least);
  EXPECT_LE(least, 0.2);
  EXPECT_EQ(stop_link(), 0);
}

TEST_F(NetemLink, CarriesFiveThousandPacketsASecondWithoutLoss) {
  start_link("lan");
  constexpr int kPackets = 10'000;
  constexpr std::size_t kBytes = 300;
  const int fd = udp_socket();
  const sockaddr_in to = address(kOverLink);
  std::vector<bool> back(kPackets, false);
  int received = 0;
  const auto receive = [&](int wait_ms) {
    pollfd ready{fd, POLLIN, 0};
    if (::poll(&ready, 1, wait_ms) <= 0) return false;
    int index[kBytes / sizeof(int)];
    while (::recv(fd, index, sizeof(index), MSG_DONTWAIT) > 0) {
      if (index[0] >= 0 && index[0] < kPackets && !back[index[0]]) {
        back[index[0]] = true;
        ++received;
      }
    }
    return true;
  };
  const auto start = Clock::now();
  for (int i = 0; i < kPackets; ++i) {
    std::this_thread::sleep_until(start + i * std::chrono::microseconds(200));
    int packet[kBytes / sizeof(int)] = {i};
    ASSERT_EQ(::sendto(fd, packet, sizeof(packet), 0, reinterpret_cast<const sockaddr*>(&to), sizeof(to)),
              static_cast<ssize_t>(sizeof(packet)));
    receive(0);
  }
  const double sent_s = ms_since(start) / 1e3;
  while (received < kPackets && receive(1000)) {
  }
  ::close(fd);
  std::printf("%d of %d packets came back, sent at %.0f a second\n", received, kPackets, kPackets / sent_s);
  EXPECT_EQ(received, kPackets);
  EXPECT_EQ(stop_link(), 0);
}

}  // namespace
}  // namespace telekerf::integration
