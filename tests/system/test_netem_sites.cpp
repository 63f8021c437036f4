// SPDX-License-Identifier: Apache-2.0
// Two machines in one: master in one network namespace, slave and vision in another, joined by nothing but
// the emulated link. They find each other and cut, with ordinary multicast discovery and with unicast peers
// only, and the round trip that they measure is the profile's.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/system/machine_noise.h"
#include "tests/system/namespaces.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;

class NetemSites : public testing::TestWithParam<bool> {};

TEST_P(NetemSites, CutAcrossTheEmulatedLink) {
  const bool unicast_only = GetParam();
  Namespaces& both = Namespaces::instance();
  if (!both.obstacle().empty()) GTEST_SKIP() << both.obstacle();
  const auto folder = std::filesystem::path(testing::TempDir()) /
                      ("telekerf-sites-" + std::to_string(::getpid()) + (unicast_only ? "-unicast" : ""));
  std::filesystem::create_directories(folder);
  const std::string out = (folder / "cut").string();
  const auto program = [](const std::string& name) { return std::string(TELEKERF_BIN_DIR) + "/" + name; };
  const auto output = [&](const std::string& name) { return (folder / (name + ".txt")).string(); };

  SidedProgram link(
      Side::kOperator,
      {program("telekerf-netem"), "link", "thesis-constant", "--slave-netns", both.slave_path()},
      output("link"));
  ASSERT_TRUE(link.says("link up", seconds(10))) << link.output();
  std::vector<std::string> operator_bus = {"--cell", "sites"};
  std::vector<std::string> slave_bus = {"--cell", "sites"};
  if (unicast_only) {
    ASSERT_EQ(std::system("ip link set tk-operator multicast off"), 0);
    ASSERT_TRUE(both.in_slave("ip link set tk-slave multicast off"));
    operator_bus.insert(operator_bus.end(), {"--peers", "10.77.0.2"});
    slave_bus.insert(slave_bus.end(), {"--peers", "10.77.0.1"});
  }
  const auto command = [&](const std::string& name, const std::vector<std::string>& bus,
                           std::vector<std::string> more) {
    std::vector<std::string> words = {program(name)};
    words.insert(words.end(), bus.begin(), bus.end());
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  {
    SidedProgram vision(Side::kSlave, command("telekerf-vision", slave_bus, {"--image", "heart"}),
                        output("vision"));
    SidedProgram slave(Side::kSlave, command("telekerf-slave", slave_bus, {"--record", out}),
                       output("slave"));
    SidedProgram master(Side::kOperator,
                        command("telekerf-master", operator_bus,
                                {"--record", out, "--engage", "--duration-s", "8", "--wait-s", "30"}),
                        output("master"));
    ASSERT_EQ(master.wait(seconds(90)), 0) << master.output() << slave.output() << vision.output();
    slave.interrupt();
    vision.interrupt();
    EXPECT_EQ(slave.wait(seconds(20)), 0) << slave.output();
    EXPECT_EQ(vision.wait(seconds(20)), 0) << vision.output();
  }
  SidedProgram inspect(Side::kOperator, {program("telekerf-inspect"), "run", out}, output("inspect"));
  ASSERT_EQ(inspect.wait(seconds(60)), 0) << inspect.output();
  const auto report = nlohmann::json::parse(std::ifstream(out + "/report.json"));
  const double p50 = report["link"]["rtt_ms"]["p50"].get<double>();
  std::printf("%s: RTT p50 %.2f ms (profile 100 ms), coverage %.3f, tracking %.1f um rms\n",
              unicast_only ? "unicast peers only" : "multicast discovery", p50,
              report["cut"]["coverage"].get<double>(), report["tracking"]["rms_um"].get<double>());
  EXPECT_GE(p50, 100.0);  // nothing arrives early ...
  EXPECT_LE(p50, 120.0);  // ... and what comes on top is the machine's scheduling
  const double slack = slack_of(report);
  EXPECT_GT(slack * report["cut"]["coverage"].get<double>(), 0.5) << "8 s of hand motion: 0.64";
  EXPECT_LE(report["tracking"]["rms_um"].get<double>(), slack * 15.0) << "0.7; " << report.dump(2);
  EXPECT_EQ(report["cut"]["energy_outside_corridor_j"].get<double>(), 0.0);
  link.interrupt();
  EXPECT_EQ(link.wait(seconds(10)), 0) << link.output();
  std::printf("%s", link.output().c_str());
  std::filesystem::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(Discovery, NetemSites, testing::Bool(), [](const auto& parameter) {
  return parameter.param ? std::string("UnicastPeersOnly") : std::string("Multicast");
});

}  // namespace
}  // namespace telekerf::integration
