// SPDX-License-Identifier: Apache-2.0
// Two machines in one, joined by an Ethernet link: what crosses it, counted frame by frame.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/system/capture.h"
#include "tests/system/namespaces.h"

namespace telekerf::integration {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// A pair of Ethernet interfaces between the two, up and with multicast. False: not possible here.
bool join(const Namespaces& both) {
  const std::string slave = "nsenter --net=" + both.slave_path() + " ";
  const auto run = [](const std::string& command) { return std::system(command.c_str()) == 0; };
  return run("ip link add wire-operator type veth peer name wire-slave netns " + both.slave_path()) &&
         run("ip address add 10.78.0.1/24 dev wire-operator") && run("ip link set wire-operator up") &&
         run("ip route add 239.0.0.0/8 dev wire-operator") &&
         run(slave + "ip address add 10.78.0.2/24 dev wire-slave") &&
         run(slave + "ip link set wire-slave up") && run(slave + "ip route add 239.0.0.0/8 dev wire-slave");
}

TEST(WireFrames, EachBlockCrossesOnceAndCostsWhatIsSaid) {
  Namespaces& both = Namespaces::instance();
  if (!both.obstacle().empty()) GTEST_SKIP() << both.obstacle();
  if (!join(both)) GTEST_SKIP() << "no Ethernet pair can be set up here";
  Capture capture("wire-operator");
  ASSERT_TRUE(capture.is_open());
  const auto folder =
      std::filesystem::path(testing::TempDir()) / ("telekerf-wire-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const auto program = [&](Side side, const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> words = {std::string(TELEKERF_BIN_DIR) + "/" + name, "--cell", "wire", "--netem",
                                      "thesis-constant"};
    words.insert(words.end(), more.begin(), more.end());
    return SidedProgram(side, words, (folder / (name + ".txt")).string());
  };
  // The slave is not the first participant of its host.
  SidedProgram vision = program(Side::kSlave, "telekerf-vision", {"--image", "heart"});
  ASSERT_TRUE(vision.says("points", seconds(20))) << vision.output();
  SidedProgram slave = program(Side::kSlave, "telekerf-slave", {});
  SidedProgram master = program(Side::kOperator, "telekerf-master", {"--engage", "--wait-s", "30"});
  ASSERT_TRUE(master.says("the slave follows", seconds(60))) << master.output() << slave.output();

  const Counted counted = capture.count(milliseconds(6000));
  const double all = counted.bytes_per_s(counted.commands) + counted.bytes_per_s(counted.states) +
                     counted.bytes_per_s(counted.others);
  std::printf(
      "commands %.1f bytes a frame, states %.1f, everything else %.0f bytes/s, all %.0f bytes/s, %llu "
      "copies\n",
      counted.commands.mean(), counted.states.mean(), counted.bytes_per_s(counted.others), all,
      static_cast<unsigned long long>(counted.copies));
  EXPECT_GT(counted.commands.frames, 200u);
  EXPECT_GT(counted.states.frames, 200u);
  EXPECT_EQ(counted.copies, 0u);
  EXPECT_EQ(counted.miscounted, 0u);
  // Loops that other work holds up have jumps in their motion to tell: states of 201.6 bytes were seen where
  // no block was late, of up to 284 where some were. The tight bounds are held in virtual time
  // (tests/unit/simulation/test_wire_bytes.cpp).
  const double blocks_per_s = static_cast<double>(counted.states.frames) / counted.seconds;
  const double slack = blocks_per_s >= 0.995 * 1000.0 / 16.0 ? 1.05 : 2.0;
  EXPECT_LE(counted.commands.mean(), slack * 150.0);
  EXPECT_LE(counted.states.mean(), slack * 200.0);
  EXPECT_LE(all, slack * 25'000.0);
  // Two pairs of processes across the link: master with slave, master with vision.
  EXPECT_LE(counted.bytes_per_s(counted.others), 2 * 3000.0);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace telekerf::integration
