// SPDX-License-Identifier: Apache-2.0
// Networks that come up late and addresses that change, on two namespaces with a cable in between.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/system/namespaces.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;

TEST(FieldNetwork, OneThatComesUpLateAndAnAddressThatChangesAreNoticed) {
  const Namespaces& two = Namespaces::instance();
  if (!two.obstacle().empty()) GTEST_SKIP() << two.obstacle();
  const std::string folder =
      (std::filesystem::temp_directory_path() / ("telekerf-cable-" + std::to_string(::getpid()))).string();
  std::filesystem::create_directories(folder);
  ::setenv("XDG_STATE_HOME", folder.c_str(), 1);  // NOLINT
  const std::string holder = two.slave_path().substr(6, two.slave_path().find('/', 6) - 6);
  ASSERT_EQ(std::system(("ip link add cable-a type veth peer name cable-b netns " + holder).c_str()), 0);

  const auto start = [&](Side side, const std::string& program, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{std::string(TELEKERF_BIN_DIR) + "/" + program, "--cell", "cable"};
    words.insert(words.end(), more.begin(), more.end());
    return std::make_unique<SidedProgram>(side, words, folder + "/" + program + ".txt");
  };
  const auto vision = start(Side::kSlave, "telekerf-vision", {"--image", "circle"});
  const auto slave = start(Side::kSlave, "telekerf-slave");
  const auto master = start(Side::kOperator, "telekerf-master", {"--engage"});
  EXPECT_TRUE(master->says(
      "waiting for a contour; seen in cell 'cable' of domain 0: nobody; this computer has no network",
      seconds(15)))
      << master->output();

  const std::string multicast = "ip route add 224.0.0.0/4 dev ";
  // An address may be there long before its link is.
  ASSERT_TRUE(two.in_slave("ip addr add 10.77.0.2/24 dev cable-b"));
  std::this_thread::sleep_for(std::chrono::milliseconds(1300));
  ASSERT_TRUE(two.in_slave("ip link set cable-b up; " + multicast + "cable-b"));
  ASSERT_EQ(
      std::system(
          ("ip addr add 10.77.0.1/24 dev cable-a; ip link set cable-a up; " + multicast + "cable-a").c_str()),
      0);
  EXPECT_TRUE(master->says("engaged: the slave follows", seconds(20))) << master->output();
  EXPECT_TRUE(slave->says("beam on", seconds(10))) << slave->output();

  ASSERT_EQ(std::system(("ip addr del 10.77.0.1/24 dev cable-a; ip addr add 10.77.0.9/24 dev cable-a; " +
                         multicast + "cable-a 2> /dev/null; true")
                            .c_str()),
            0);
  std::this_thread::sleep_for(seconds(1));
  const auto stop = start(Side::kSlave, "telekerf-ctl", {"stop"});  // said at the other end of the cable
  EXPECT_EQ(stop->wait(seconds(20)), 0) << stop->output();
  EXPECT_TRUE(stop->says("master, slave confirmed it", seconds(1)) ||
              stop->says("slave, master confirmed it", seconds(1)))
      << stop->output();
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
}

}  // namespace
}  // namespace telekerf::integration
