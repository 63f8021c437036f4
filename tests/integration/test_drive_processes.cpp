// SPDX-License-Identifier: Apache-2.0
// Stations whose robot is in another process (telekerf-robot), and what they do when that process dies.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/integration/robot_process.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;

std::vector<std::string> cell(std::vector<std::string> more) {
  std::vector<std::string> all = {"--domain", own_domain(), "--cell", "drive"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

/// What stands in a CSV's column, of its last row.
double last_of(const std::string& file, const std::string& column) {
  std::ifstream in(file);
  std::string header, row, line;
  std::getline(in, header);
  while (std::getline(in, line)) row = line;
  const std::size_t at = header.find(column);
  if (at == header.npos || row.empty()) return -1.0;
  std::stringstream cells(row);
  std::string text;
  for (auto left = std::count(header.begin(), header.begin() + static_cast<long>(at), ',');
       std::getline(cells, text, ',') && left > 0; --left) {
  }
  return std::stod(text);
}

TEST(DriveProcesses, TheSlaveFollowsWithItAndStopsSafelyWithoutIt) {
  const std::string out = (Program::scratch() / "followed").string();
  RobotProcess robot("slave-keops");
  ASSERT_NE(robot.drive(), "") << robot.output();
  Program vision("telekerf-vision", cell({"--image", "heart"}));
  Program slave("telekerf-slave",
                cell({"--record", out, "--drive", robot.drive(), "--drive-stale-s", "0.5"}));
  Program master("telekerf-master", cell({"--record", out, "--engage"}));
  EXPECT_TRUE(
      slave.says(robot.drive() + " is not simulated: what is recorded is the measured tool", seconds(20)))
      << slave.output();
  ASSERT_TRUE(slave.says("following", seconds(30))) << slave.output() << master.output();
  std::this_thread::sleep_for(seconds(5));
  robot.kill();
  EXPECT_EQ(slave.wait(seconds(20)), 2) << slave.output();
  EXPECT_TRUE(slave.says("drive = " + robot.drive() + ": no reading for 0.5 s", seconds(1)))
      << slave.output();
  EXPECT_TRUE(master.says("the slave does not follow", seconds(10))) << master.output();
  master.interrupt();
  ASSERT_EQ(master.wait(seconds(10)), 0) << master.output();

  EXPECT_EQ(last_of(out + "/slave.csv", "laser_w"), 0.0);
  Program inspect("telekerf-inspect", {"run", out});
  ASSERT_EQ(inspect.wait(seconds(30)), 0) << inspect.output();
  EXPECT_TRUE(inspect.says("as measured by " + robot.drive() + ": nobody knows the true one", seconds(1)));
  const auto report = nlohmann::json::parse(std::ifstream(out + "/report.json"));
  EXPECT_EQ(report["drive"]["slave"]["name"].get<std::string>(), robot.drive());
  EXPECT_EQ(report["drive"]["slave"]["tool"].get<std::string>(), "measured");
  EXPECT_EQ(report["drive"]["master"]["tool"].get<std::string>(), "true");
  EXPECT_LE(report["tracking"]["rms_um"].get<double>(), 150.0) << report.dump(2);
  EXPECT_EQ(report["cut"]["energy_outside_corridor_j"].get<double>(), 0.0);
  EXPECT_GE(report["cut"]["coverage"].get<double>(), 0.1) << "5 s of hand motion";
}

TEST(DriveProcesses, TheMasterMovesItToTheContourAndInventsNoHand) {
  const std::string out = (Program::scratch() / "operated").string();
  RobotProcess robot("master-horizontal");
  ASSERT_NE(robot.drive(), "") << robot.output();
  const std::string config = (Program::scratch() / "master.toml").string();
  std::ofstream(config) << "drive = \"" << robot.drive() << "\"\ndrive_stale_s = 2.0\n";
  Program vision("telekerf-vision", cell({"--image", "heart"}));
  Program slave("telekerf-slave", cell({"--record", out}));
  Program master("telekerf-master",
                 cell({"--record", out, "--engage", "--duration-s", "2", "--config", config}));
  ASSERT_EQ(master.wait(seconds(60)), 0) << master.output() << slave.output();
  EXPECT_TRUE(master.says(robot.drive() + " is not simulated, so no hand is either", seconds(1)));
  EXPECT_TRUE(master.says("engaged: the slave follows", seconds(1))) << master.output();
  slave.interrupt();
  ASSERT_EQ(slave.wait(seconds(10)), 0) << slave.output();
  Program inspect("telekerf-inspect", {"run", out});
  ASSERT_EQ(inspect.wait(seconds(30)), 0) << inspect.output();
  const auto report = nlohmann::json::parse(std::ifstream(out + "/report.json"));
  EXPECT_EQ(report["drive"]["master"]["tool"].get<std::string>(), "measured");
  EXPECT_EQ(report["drive"]["slave"]["tool"].get<std::string>(), "true");
  EXPECT_GT(report["constraint"]["samples"].get<int>(), 1000);
  EXPECT_LE(report["constraint"]["rms_um"].get<double>(), 300.0) << report.dump(2);
  EXPECT_EQ(report["cut"]["laser_on_s"].get<double>(), 0.0) << "nobody held the button";
}

std::vector<std::string> machining(const RobotProcess& robot, const std::string& out) {
  return cell(
      {"--automatic", "--no-framing", "--record", out, "--drive", robot.drive(), "--drive-stale-s", "0.5"});
}

TEST(DriveProcesses, ItMachinesAContour) {
  const std::string out = (Program::scratch() / "machined").string();
  RobotProcess robot("slave-keops");
  ASSERT_NE(robot.drive(), "") << robot.output();
  Program vision("telekerf-vision", cell({"--image", "circle", "--width-mm", "12"}));
  auto arguments = machining(robot, out);
  arguments.insert(arguments.end(), {"--speed-mm-s", "20"});
  Program slave("telekerf-slave", arguments);
  ASSERT_EQ(slave.wait(seconds(60)), 0) << slave.output() << vision.output();
  const auto result = nlohmann::json::parse(std::ifstream(out + "/result.json"));
  EXPECT_TRUE(result["finished"].get<bool>());
  EXPECT_EQ(result["drive"]["tool"].get<std::string>(), "measured");
  EXPECT_TRUE(result["sensor"].is_null()) << "nobody told";
  EXPECT_LE(result["contour_error_um"]["rms"].get<double>(), 20.0) << result.dump(2);
  EXPECT_EQ(result["burn"]["energy_outside_corridor_j"].get<double>(), 0.0);
  robot.interrupt();
  EXPECT_EQ(robot.wait(seconds(10)), 0) << robot.output();
}

TEST(DriveProcesses, ItsLossEndsTheMachiningWithTheBeamOut) {
  const std::string out = (Program::scratch() / "lost").string();
  RobotProcess robot("slave-keops");
  ASSERT_NE(robot.drive(), "") << robot.output();
  Program vision("telekerf-vision", cell({"--image", "circle", "--width-mm", "12"}));
  Program slave("telekerf-slave", machining(robot, out));
  ASSERT_TRUE(slave.says("cutting", seconds(30))) << slave.output();
  std::this_thread::sleep_for(seconds(1));
  robot.kill();
  EXPECT_EQ(slave.wait(seconds(20)), 2) << slave.output();
  EXPECT_TRUE(slave.says("drive = " + robot.drive() + ": no reading for 0.5 s", seconds(1)))
      << slave.output();
  const auto result = nlohmann::json::parse(std::ifstream(out + "/result.json"));
  EXPECT_FALSE(result["finished"].get<bool>());
  EXPECT_GT(result["burn"]["energy_inside_j"].get<double>(), 0.0) << "it had been cutting";
  EXPECT_EQ(last_of(out + "/trace.csv", "laser_w"), 0.0);
  EXPECT_EQ(result["burn"]["energy_outside_corridor_j"].get<double>(), 0.0);
}

}  // namespace
}  // namespace telekerf::integration
