// SPDX-License-Identifier: Apache-2.0
// ./telekerf machine's processes on loopback: vision and telekerf-machine.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/recording/run_reader.h"
#include "tests/system/programs.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;

std::vector<std::string> with(std::vector<std::string> more) {
  std::vector<std::string> all = {"--domain", own_domain(), "--cell", "machine"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

/// Power in the last line of a trace, and the largest in all of it.
std::pair<double, double> laser_of(const std::string& trace) {
  std::ifstream in(trace);
  double last = -1.0, most = 0.0;
  std::string line;
  for (std::getline(in, line); std::getline(in, line);) {
    last = std::stod(line.substr(line.rfind(',') + 1));
    most = std::max(most, last);
  }
  return {last, most};
}

TEST(Machine, CutsEveryContourOfAFlangeFromTheInsideOut) {
  const std::string out = (Program::scratch() / "flange").string();
  Program vision("telekerf-vision", with({"--image", "flange", "--width-mm", "12"}));
  Program machine("telekerf-machine",
                  with({"--speed-mm-s", "50", "--material", "fibreglass", "--record", out}));
  ASSERT_EQ(machine.wait(seconds(60)), 0) << machine.output() << vision.output();
  for (const std::string said : {"7 contours to cut", "framing, pilot beam only", "90 %", "finished"})
    EXPECT_NE(machine.output().find(said), std::string::npos) << said << "\n" << machine.output();
  const auto result = nlohmann::json::parse(std::ifstream(out + "/result.json"));
  EXPECT_EQ(result["contours_cut"].get<int>(), 7);
  EXPECT_EQ(result["order"].back().get<int>(), 0) << "the rim comes last";
  EXPECT_LE(result["normal_error_um"]["rms"].get<double>(), 5.0) << result.dump(2);
  EXPECT_LE(result["contour_error_um"]["max"].get<double>(), 25.0) << result.dump(2);
  EXPECT_EQ(result["burn"]["material"].get<std::string>(), "fibreglass");
  EXPECT_GT(result["burn"]["energy_inside_j"].get<double>(), 5.0);
  EXPECT_EQ(result["burn"]["energy_outside_corridor_j"].get<double>(), 0.0);
  EXPECT_EQ(result["limit_violations"].get<int>(), 0);
  for (const std::string file : {"timing.json", "trace.csv", "mark.png", "depth.png"})
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(out) / file)) << file;
  const RunReader recording(out + "/machine.h5");
  EXPECT_EQ(recording.state(), RunState::kClosed);
  EXPECT_EQ(recording.identity().role, "machine");
  EXPECT_EQ(recording.contours().size(), 1u);
  const SeriesData rows = recording.data("machine").value();
  const auto column = [&](const std::string& name) {
    std::size_t at = 0;
    while (at < rows.schema.width() && rows.schema.columns[at].name != name) ++at;
    return at;
  };
  double energy_j = 0.0;
  for (std::size_t n = 0; n < rows.rows(); ++n) {
    EXPECT_EQ(rows.row(n)[column("tick")], static_cast<double>(n));
    energy_j += rows.row(n)[column("laser_w")] * result["time_s"].get<double>() / static_cast<double>(rows.rows());
  }
  EXPECT_NEAR(energy_j, result["burn"]["energy_inside_j"].get<double>(), 0.01 * energy_j) << "all light is in the record";
}

TEST(Machine, AnInterruptPutsTheBeamOutAndStillReports) {
  const std::string out = (Program::scratch() / "stopped").string();
  Program vision("telekerf-vision", with({"--image", "circle"}));
  Program machine("telekerf-machine", with({"--no-framing", "--record", out}));
  ASSERT_TRUE(machine.says("cutting", seconds(30))) << machine.output();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  machine.interrupt();
  ASSERT_EQ(machine.wait(seconds(20)), 1) << machine.output();
  const auto result = nlohmann::json::parse(std::ifstream(out + "/result.json"));
  EXPECT_FALSE(result["finished"].get<bool>());
  const auto [last_w, most_w] = laser_of(out + "/trace.csv");
  EXPECT_GT(most_w, 5.0);
  EXPECT_EQ(last_w, 0.0);
}

TEST(Machine, WithoutVisionItSaysWhatItWaitsForAndGivesUp) {
  if (everyone_has_keys()) GTEST_SKIP() << "is about what is said without keys";
  Program machine("telekerf-machine", with({"--wait-s", "2"}));
  ASSERT_EQ(machine.wait(seconds(30)), 2) << machine.output();
  const std::string said = machine.output();
  const std::string waiting = "machine: waiting for a contour from telekerf-vision in cell 'machine'";
  const auto at = said.find(waiting);
  ASSERT_NE(at, std::string::npos) << said;
  EXPECT_EQ(said.find(waiting, at + 1), std::string::npos) << said;
  EXPECT_NE(said.find("no contour for 2 s in cell 'machine'"), std::string::npos) << said;
  EXPECT_TRUE(said.starts_with("machine: not secured")) << said;  // what follows depends on the network here
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 4) << said;
}

TEST(Machine, WhatDoesNotFitIsRefusedWithOneSentence) {
  for (const auto& [flag, value] : std::vector<std::pair<std::string, std::string>>{
           {"--material", "cheese"}, {"--controller", "magic"}, {"--speed-mm-s", "0"}, {"--kerf-um", "-1"}}) {
    Program machine("telekerf-machine", with({flag, value}));
    EXPECT_EQ(machine.wait(seconds(20)), 2) << flag;
    const std::string said = machine.output();
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  }
}

}  // namespace
}  // namespace telekerf::integration
