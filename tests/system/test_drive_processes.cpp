// SPDX-License-Identifier: Apache-2.0
// Stations whose robot (telekerf-robot) or laser is in another process, and what they do when the robot dies.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/system/machine_noise.h"
#include "tests/system/robot_process.h"
#include "tests/system/spoiled_drive.h"
#include "tests/unit/laser/laser_device.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;

std::vector<std::string> cell(std::vector<std::string> more) {
  std::vector<std::string> all = {"--domain", own_domain(), "--cell", "drive"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

/// What stands in a CSV's column.
std::vector<double> column_of(const std::string& file, const std::string& column) {
  std::ifstream in(file);
  std::string header, line;
  std::getline(in, header);
  const std::size_t at = header.find(column);
  std::vector<double> values;
  while (at != header.npos && std::getline(in, line)) {
    std::stringstream cells(line);
    std::string text;
    for (auto left = std::count(header.begin(), header.begin() + static_cast<long>(at), ',');
         std::getline(cells, text, ',') && left > 0; --left) {
    }
    values.push_back(std::stod(text));
  }
  return values;
}

/// Distance of the tool from where it should be, in the plane, over the ticks with light.
double median_deviation_um(const std::string& trace) {
  const auto tool_x = column_of(trace, "tool_x_m"), tool_y = column_of(trace, "tool_y_m");
  const auto ref_x = column_of(trace, "ref_x_m"), ref_y = column_of(trace, "ref_y_m");
  const auto laser_w = column_of(trace, "laser_w");
  std::vector<double> um;
  for (std::size_t i = 0; i < laser_w.size(); ++i)
    if (laser_w[i] > 0.0) um.push_back(1e6 * std::hypot(tool_x[i] - ref_x[i], tool_y[i] - ref_y[i]));
  EXPECT_GT(um.size(), 1000u) << trace;
  if (um.empty()) return std::numeric_limits<double>::infinity();
  std::nth_element(um.begin(), um.begin() + static_cast<long>(um.size() / 2), um.end());
  return um[um.size() / 2];
}

long lit_of(const std::vector<double>& laser_w) {
  return std::count_if(laser_w.begin(), laser_w.end(), [](double power_w) { return power_w > 0.0; });
}

/// A laser in this process; it listens until it is judged.
class LaserAtWork {
 public:
  std::string name() const { return socket_.laser(); }

  /// After the slave's end: off, and lit in the record's steps alone.
  void judge(const std::vector<double>& recorded_w) {
    listener_.request_stop();
    listener_.join();
    EXPECT_EQ(refused_, 0);
    EXPECT_GT(lit_, 100) << "it had been cutting";
    EXPECT_EQ(newest_.power_w, 0.0);
    EXPECT_EQ(newest_.pilot, 0u);
    const long missing = static_cast<long>(newest_.sequence) - told_;  // where a listener is not scheduled
    const long recorded = lit_of(recorded_w);
    EXPECT_LE(lit_, recorded);
    // A step that comes so late that the laser has gone dark by itself is told dark.
    EXPECT_GE(lit_, recorded - missing - recorded / 50) << recorded << " are recorded";
  }
  bool is_on() const { return on_; }

 private:
  void listen(const std::stop_token& stop) {
    for (bool last = false; !last; std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
      last = stop.stop_requested();
      while (const auto arrival = socket_.take()) {
        const auto now_ns = std::chrono::steady_clock::now().time_since_epoch().count();
        ++(device_.hear(arrival->told, arrival->size, arrival->from, now_ns) ? told_ : refused_);
        newest_ = arrival->told;
        on_ = newest_.power_w > 0.0;
        lit_ += newest_.power_w > 0.0 ? 1 : 0;
      }
    }
  }

  laser::LaserSocket socket_;
  laser::UdpLaserDevice device_{20.0};
  laser::UdpPower newest_;
  long told_ = 0, refused_ = 0, lit_ = 0;
  std::atomic<bool> on_ = false;
  std::jthread listener_{[this](const std::stop_token& stop) { listen(stop); }};
};

TEST(DriveProcesses, TheSlaveFollowsWithItAndStopsSafelyWithoutIt) {
  const std::string out = (Program::scratch() / "followed").string();
  RobotProcess robot("slave-keops");
  ASSERT_NE(robot.drive(), "") << robot.output();
  Program vision("telekerf-vision", cell({"--image", "heart"}));
  Program slave("telekerf-slave",
                cell({"--record", out, "--drive", robot.drive(), "--drive-stale-s", "0.5"}));
  Program master("telekerf-master", cell({"--record", out, "--engage"}));
  EXPECT_TRUE(slave.says(robot.drive() + " is not simulated: the measured tool is recorded", seconds(20)))
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

  EXPECT_EQ(column_of(out + "/slave.csv", "laser_w").back(), 0.0);
  Program inspect("telekerf-inspect", {"run", out});
  ASSERT_EQ(inspect.wait(seconds(30)), 0) << inspect.output();
  EXPECT_TRUE(inspect.says("as measured by " + robot.drive() + ": nobody knows the true one", seconds(1)));
  const auto report = nlohmann::json::parse(std::ifstream(out + "/report.json"));
  EXPECT_EQ(report["drive"]["slave"]["name"].get<std::string>(), robot.drive());
  EXPECT_EQ(report["drive"]["slave"]["tool"].get<std::string>(), "measured");
  EXPECT_EQ(report["drive"]["master"]["tool"].get<std::string>(), "true");
  const double slack = slack_of(report);
  EXPECT_LE(report["tracking"]["rms_um"].get<double>(), slack * 15.0) << report.dump(2);
  EXPECT_EQ(report["cut"]["energy_outside_corridor_j"].get<double>(), 0.0);
  EXPECT_GE(slack * report["cut"]["coverage"].get<double>(), 0.25) << "5 s of hand motion: 0.36";
}

/// The shipped robot file with another line at its head.
std::string keops_with(const std::string& line, const std::string& name) {
  const std::string file = (Program::scratch() / name).string();
  std::ifstream shipped(TELEKERF_ROBOTS "/slave-keops.toml");
  std::ofstream(file) << line << "\n" << shipped.rdbuf();
  return file;
}

nlohmann::json measured_delay(const std::string& drive, const std::string& control_hz = "1000") {
  Program inspect("telekerf-inspect", {"drive", "--drive", drive, "--drive-stale-s", "0.5", "--control-hz",
                                       control_hz, "--move", "--json"});
  EXPECT_EQ(inspect.wait(seconds(30)), 0) << inspect.output();
  return nlohmann::json::parse(inspect.output(), nullptr, false);
}

TEST(DriveProcesses, OneThatReadsNonsenseIsRefusedInWordsAndEndsTheSlave) {
  RobotProcess robot("slave-keops");
  ASSERT_NE(robot.drive(), "") << robot.output();
  SpoiledDrive way(robot.drive());
  Program slave("telekerf-slave", cell({"--drive", way.drive(), "--drive-stale-s", "5"}));
  ASSERT_TRUE(slave.says("ready in", seconds(30))) << slave.output();
  EXPECT_FALSE(slave.says("no place", seconds(1))) << slave.output();
  way.spoil();
  EXPECT_EQ(slave.wait(seconds(20)), 2) << slave.output();
  EXPECT_TRUE(slave.says("or what is no number; who sends to it", seconds(1))) << slave.output();
  EXPECT_TRUE(slave.says("no reading for 5 s (drive_stale_s), so the laser is off and the currents are zero",
                         seconds(1)))
      << slave.output();
}

TEST(DriveProcesses, ItsDelayIsMeasuredAndOnceStatedTheSlaveCutsWithItToTheEnd) {
  RobotProcess robot(keops_with("drive_delay_s = 0.001", "late.toml"));
  ASSERT_NE(robot.drive(), "") << robot.output();
  const auto delay = measured_delay(robot.drive());
  EXPECT_NEAR(delay["drive_delay_s"].get<double>(), 1e-3, 1e-4) << delay.dump(2);
  EXPECT_LE(delay["deviation_s"].get<double>(), 1e-4);
  EXPECT_EQ(delay["file_drive_delay_s"].get<double>(), 0.0);
  EXPECT_LE(delay["travel_m"].get<double>(), 1e-3);
  std::this_thread::sleep_for(std::chrono::milliseconds(600));  // the measurement's address has gone

  const std::string out = (Program::scratch() / "late").string();
  const std::string stated = keops_with(delay["robot_file"].get<std::string>(), "stated.toml");
  Program vision("telekerf-vision", cell({"--image", "heart"}));
  Program slave("telekerf-slave", cell({"--record", out, "--robot", stated, "--drive", robot.drive(),
                                        "--drive-stale-s", "0.5"}));
  Program master("telekerf-master", cell({"--record", out, "--engage", "--duration-s", "24"}));
  ASSERT_EQ(master.wait(seconds(60)), 0) << master.output() << slave.output();
  slave.interrupt();
  ASSERT_EQ(slave.wait(seconds(10)), 0) << slave.output();
  Program inspect("telekerf-inspect", {"run", out});
  ASSERT_EQ(inspect.wait(seconds(30)), 0) << inspect.output();
  const auto report = nlohmann::json::parse(std::ifstream(out + "/report.json"));
  const double slack = slack_of(report);
  EXPECT_LE(report["tracking"]["rms_um"].get<double>(), slack * 4.0) << "1.6; " << report.dump(2);
  EXPECT_LE(report["tracking"]["max_um"].get<double>(), slack * 60.0) << "14 to 25";
  EXPECT_GE(report["cut"]["coverage"].get<double>(), 1.0 - slack * 0.01);
  EXPECT_EQ(report["cut"]["energy_outside_corridor_j"].get<double>(), 0.0);
}

TEST(DriveProcesses, ADelayThatNobodyHasStatedEndsTheSlaveWithASentence) {
  RobotProcess robot(keops_with("drive_delay_s = 0.001", "late-unsaid.toml"));
  ASSERT_NE(robot.drive(), "") << robot.output();
  Program vision("telekerf-vision", cell({"--image", "heart"}));
  Program slave("telekerf-slave", cell({"--drive", robot.drive(), "--drive-stale-s", "0.5"}));
  Program master("telekerf-master", cell({"--engage"}));
  EXPECT_EQ(slave.wait(seconds(40)), 2) << slave.output();
  EXPECT_TRUE(slave.says("the laser is off and the currents are zero", seconds(1))) << slave.output();
  EXPECT_TRUE(slave.says("drive_delay_s", seconds(1))) << slave.output();
  master.interrupt();
  EXPECT_EQ(master.wait(seconds(10)), 0) << master.output();
}

TEST(DriveProcesses, ItIsNotMovedWithoutAWordAndNotMeasuredWhereThereIsNone) {
  RobotProcess robot("slave-keops");
  ASSERT_NE(robot.drive(), "") << robot.output();
  Program asked("telekerf-inspect", {"drive", "--drive", robot.drive()});
  EXPECT_EQ(asked.wait(seconds(10)), 2) << asked.output();
  EXPECT_TRUE(asked.says("with up to 1.44 N and lets none go farther than 4 mm", seconds(1)))
      << asked.output();
  EXPECT_TRUE(asked.says("say --move", seconds(1)));
  robot.interrupt();
  ASSERT_EQ(robot.wait(seconds(10)), 0);
  EXPECT_TRUE(robot.says("robot: 0 steps", seconds(1))) << robot.output();
  Program lonely("telekerf-inspect", {"drive", "--drive", robot.drive(), "--move"});
  EXPECT_EQ(lonely.wait(seconds(20)), 2) << lonely.output();
  EXPECT_TRUE(lonely.says("no reading for 5 s; is it switched on", seconds(1))) << lonely.output();
}

TEST(DriveProcesses, TheOneSimulatedHereIsMeasuredWithoutAWord) {
  const std::string late = keops_with("drive_delay_s = 0.0015", "late-here.toml");
  const std::string out = (Program::scratch() / "measured").string();
  Program inspect("telekerf-inspect", {"drive", "--robot", late, "--mismatch", "0.3", "--out", out});
  ASSERT_EQ(inspect.wait(seconds(20)), 0) << inspect.output();
  EXPECT_TRUE(inspect.says("drive_delay_s = 0.0014", seconds(1))) << inspect.output();
  const auto delay = nlohmann::json::parse(std::ifstream(out + "/drive.json"));
  EXPECT_NEAR(delay["drive_delay_s"].get<double>(), 1.5e-3, 5e-5) << delay.dump(2);
  EXPECT_EQ(delay["file_drive_delay_s"].get<double>(), 1.5e-3);
  const auto refused = [&](std::vector<std::string> more, const std::string& sentence) {
    more.insert(more.begin(), {"drive", "--robot", late});
    Program wrong("telekerf-inspect", more);
    EXPECT_EQ(wrong.wait(seconds(20)), 2) << wrong.output();
    EXPECT_TRUE(wrong.says(sentence, seconds(1))) << wrong.output();
  };
  refused({"--force-n", "11"}, "--force-n 11 is more than peak_force_n = 10.7");
  refused({"--force-n", "0.05"}, "its delay cannot be told: joint 1 does not move as its force says");
  refused({"--travel-mm", "30"}, "nearer than travel_mm = 30 to an end of its stroke (0 to 40 mm)");
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
  ASSERT_EQ(inspect.wait(seconds(30)), 1) << inspect.output();
  EXPECT_TRUE(inspect.says("nothing was cut", seconds(1))) << inspect.output();
  const auto report = nlohmann::json::parse(std::ifstream(out + "/report.json"));
  EXPECT_EQ(report["drive"]["master"]["tool"].get<std::string>(), "measured");
  EXPECT_EQ(report["drive"]["slave"]["tool"].get<std::string>(), "true");
  EXPECT_GT(report["constraint"]["samples"].get<int>(), 1000);
  EXPECT_LE(report["constraint"]["rms_um"].get<double>(), 100.0) << report.dump(2);
  EXPECT_EQ(report["cut"]["laser_on_s"].get<double>(), 0.0) << "nobody held the button";
}

std::vector<std::string> machining(const RobotProcess& robot, const std::string& out) {
  return cell({"--no-framing", "--record", out, "--drive", robot.drive(), "--drive-stale-s", "0.5"});
}

/// Its readings are as old as its file says.
class Machining : public ::testing::TestWithParam<const char*> {};

TEST_P(Machining, CutsAContourWithIt) {
  const bool late = std::string(GetParam()) != "drive_delay_s = 0";
  const std::string out = (Program::scratch() / (late ? "machined-late" : "machined")).string();
  const std::string file = keops_with(GetParam(), "machines.toml");
  RobotProcess robot(file);
  ASSERT_NE(robot.drive(), "") << robot.output();
  Program vision("telekerf-vision", cell({"--image", "circle", "--width-mm", "12"}));
  auto arguments = machining(robot, out);
  arguments.insert(arguments.end(), {"--speed-mm-s", "20", "--robot", file});
  Program slave("telekerf-machine", arguments);
  ASSERT_EQ(slave.wait(seconds(60)), 0) << slave.output() << vision.output();
  const auto result = nlohmann::json::parse(std::ifstream(out + "/result.json"));
  EXPECT_TRUE(result["finished"].get<bool>());
  EXPECT_EQ(result["drive"]["tool"].get<std::string>(), "measured");
  EXPECT_TRUE(result["sensor"].is_null()) << "nobody told";
  // The median: one pause of the machine moves the rms.
  const double slack = slack_of_machining(nlohmann::json::parse(std::ifstream(out + "/timing.json")));
  EXPECT_LE(median_deviation_um(out + "/trace.csv"), slack * 1.0) << result.dump(2);
  EXPECT_EQ(result["burn"]["energy_outside_corridor_j"].get<double>(), 0.0);
  robot.interrupt();
  EXPECT_EQ(robot.wait(seconds(10)), 0) << robot.output();
}
INSTANTIATE_TEST_SUITE_P(DriveProcesses, Machining,
                         ::testing::Values("drive_delay_s = 0", "drive_delay_s = 0.0012"),
                         [](const auto& test) { return test.index == 0 ? "InTime" : "Late"; });

TEST(DriveProcesses, ADriveTooLateToMachineWithIsRefused) {
  const std::string file = keops_with("drive_delay_s = 0.002", "too-late.toml");
  Program slave("telekerf-machine", cell({"--robot", file}));
  EXPECT_EQ(slave.wait(seconds(10)), 2) << slave.output();
  EXPECT_TRUE(slave.says("more than 4 control periods at machining_hz = 2400; lower the rate", seconds(1)))
      << slave.output();
}

TEST(DriveProcesses, ItsLossEndsTheMachiningWithTheBeamOut) {
  const std::string out = (Program::scratch() / "lost").string();
  RobotProcess robot("slave-keops");
  ASSERT_NE(robot.drive(), "") << robot.output();
  Program vision("telekerf-vision", cell({"--image", "circle", "--width-mm", "12"}));
  LaserAtWork laser;
  auto arguments = machining(robot, out);
  arguments.insert(arguments.end(), {"--laser", laser.name(), "--laser-max-w", "20"});
  Program slave("telekerf-machine", arguments);
  ASSERT_TRUE(slave.says("cutting", seconds(30))) << slave.output();
  std::this_thread::sleep_for(seconds(1));
  robot.kill();
  EXPECT_EQ(slave.wait(seconds(20)), 2) << slave.output();
  EXPECT_TRUE(slave.says("drive = " + robot.drive() + ": no reading for 0.5 s", seconds(1)))
      << slave.output();
  const auto result = nlohmann::json::parse(std::ifstream(out + "/result.json"));
  EXPECT_FALSE(result["finished"].get<bool>());
  EXPECT_GT(result["burn"]["energy_inside_j"].get<double>(), 0.0) << "it had been cutting";
  const auto laser_w = column_of(out + "/trace.csv", "laser_w");
  EXPECT_EQ(laser_w.back(), 0.0);
  laser.judge(laser_w);
  EXPECT_EQ(result["burn"]["energy_outside_corridor_j"].get<double>(), 0.0);
}

TEST(LaserProcesses, AnInterruptWhileTheHandCutsPutsTheBeamOut) {
  const std::string out = (Program::scratch() / "lit").string();
  LaserAtWork laser;
  Program vision("telekerf-vision", cell({"--image", "heart"}));
  // As one that gives no light: with any other the master does not engage by itself.
  const std::string simulated = "plant" + laser.name().substr(laser.name().find(':'));
  Program slave("telekerf-slave", cell({"--record", out, "--laser", simulated, "--laser-max-w", "20"}));
  Program master("telekerf-master", cell({"--engage"}));
  ASSERT_TRUE(slave.says("following", seconds(30))) << slave.output() << master.output();
  std::this_thread::sleep_for(seconds(3));
  for (int n = 0; n < 10000 && !laser.is_on(); ++n) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  slave.interrupt();
  ASSERT_EQ(slave.wait(seconds(10)), 0) << slave.output();
  laser.judge(column_of(out + "/slave.csv", "laser_w"));
}

TEST(LaserProcesses, ARealOneIsNotEngagedByAnOption) {
  LaserAtWork laser;
  Program vision("telekerf-vision", cell({"--image", "heart"}));
  Program slave("telekerf-slave", cell({"--laser", laser.name(), "--laser-max-w", "20"}));
  Program master("telekerf-master", cell({"--engage"}));
  EXPECT_EQ(master.wait(seconds(30)), 2) << master.output() << slave.output();
  EXPECT_TRUE(master.says("leave --engage out", seconds(1))) << master.output();
  EXPECT_FALSE(laser.is_on());
}

TEST(LaserProcesses, ALaserThatGoesAwayEndsTheMachining) {
  const std::string out = (Program::scratch() / "dark").string();
  auto laser = std::make_unique<LaserAtWork>();
  const std::string name = laser->name();
  Program vision("telekerf-vision", cell({"--image", "circle", "--width-mm", "12"}));
  Program slave("telekerf-machine",
                cell({"--no-framing", "--record", out, "--laser", name, "--laser-max-w", "20"}));
  ASSERT_TRUE(slave.says("cutting", seconds(30))) << slave.output();
  laser.reset();
  EXPECT_EQ(slave.wait(seconds(20)), 2) << slave.output();
  EXPECT_TRUE(slave.says("laser = " + name + ": it no longer hears", seconds(1))) << slave.output();
  const auto result = nlohmann::json::parse(std::ifstream(out + "/result.json"));
  EXPECT_FALSE(result["finished"].get<bool>());
  EXPECT_EQ(column_of(out + "/trace.csv", "laser_w").back(), 0.0);
}

TEST(LaserProcesses, ALaserThatIsNotThereIsRefused) {
  std::string laser;
  {
    const laser::LaserSocket closed;
    laser = closed.laser();
  }
  for (const char* program : {"telekerf-slave", "telekerf-machine"}) {
    Program slave(program, cell({"--laser", laser, "--laser-max-w", "20"}));
    EXPECT_EQ(slave.wait(seconds(10)), 2) << slave.output();
    EXPECT_TRUE(slave.says("laser = " + laser + ": Connection refused; is the laser switched on", seconds(1)))
        << slave.output();
  }
}

}  // namespace
}  // namespace telekerf::integration
