// SPDX-License-Identifier: Apache-2.0
// The real telekerf-inspect, as a user calls it.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

namespace {

struct Result {
  int exit_code = -1;
  std::string text;  // stdout and stderr
};

Result inspect(const std::string& arguments) {
  Result result;
  std::string command = TELEKERF_INSPECT " robot ";
  command += arguments;
  command += " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return result;
  std::array<char, 4096> buffer{};
  while (fgets(buffer.data(), buffer.size(), pipe) != nullptr) result.text += buffer.data();
  const int status = pclose(pipe);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

nlohmann::json json_of(const Result& result) {
  EXPECT_EQ(result.exit_code, 0) << result.text;
  return nlohmann::json::parse(result.text, nullptr, false);
}

TEST(InspectRobot, InverseAndForwardAreInverses) {
  const auto ik = json_of(inspect("master-horizontal --ik 0.01 -0.005 0.12"));
  EXPECT_NEAR(ik.at("joints_m").at(0).get<double>(), 0.00555728090000841, 1e-15);
  EXPECT_LT(ik.at("condition").get<double>(), 3);
  std::string joints;
  for (const auto& d : ik.at("joints_m")) {
    joints += ' ';
    joints += d.dump();
  }
  const auto fk = json_of(inspect("master-horizontal --fk" + joints));
  EXPECT_NEAR(fk.at("tool_m").at(1).get<double>(), -0.005, 1e-15);
  const auto jacobian = json_of(inspect("master-horizontal --jacobian" + joints));
  EXPECT_EQ(jacobian.at("jacobian").size(), 3u);
  EXPECT_EQ(jacobian.at("jacobian").at(2).size(), 3u);
}

TEST(InspectRobot, UnreachableIsExitCodeTwoAndASentence) {
  const Result far = inspect("slave-keops --ik 0.5 0 0.09");
  EXPECT_EQ(far.exit_code, 2);
  EXPECT_NE(far.text.find("too short"), std::string::npos) << far.text;
  const Result stroke = inspect("slave-keops --fk 0.02 0.05 0.02");
  EXPECT_EQ(stroke.exit_code, 2);
  EXPECT_NE(stroke.text.find("leg 2 is out of stroke"), std::string::npos) << stroke.text;
  EXPECT_EQ(inspect("no-such-robot --workspace").exit_code, 2);
  EXPECT_EQ(inspect("slave-keops").exit_code, 2);
  EXPECT_EQ(inspect("slave-keops --ik 0 0").exit_code, 2);
}

TEST(InspectRobot, WorkspaceIsPrintedAndDrawn) {
  const auto file = std::filesystem::temp_directory_path() / "telekerf-test-workspace.png";
  std::filesystem::remove(file);
  const auto out = json_of(inspect("slave-keops --workspace --picture " + file.string()));
  EXPECT_GT(out.at("radius_m").get<double>(), 0.02);
  EXPECT_GT(out.at("height_m").get<double>(), 0.005);
  EXPECT_GE(out.at("worst_condition").get<double>(), out.at("condition").get<double>());
  EXPECT_GT(std::filesystem::file_size(file), 10000u);
  std::filesystem::remove(file);
}

std::string one_sentence(const Result& result) {
  EXPECT_EQ(result.exit_code, 2) << result.text;
  EXPECT_EQ(std::count(result.text.begin(), result.text.end(), '\n'), 1) << result.text;
  return result.text;
}

TEST(InspectRobot, ANumberMayBeginWithItsPoint) {
  const auto ik = json_of(inspect("master-horizontal --ik .01 -.005 .12"));
  EXPECT_NEAR(ik.at("joints_m").at(0).get<double>(), 0.00555728090000841, 1e-15);
}

TEST(InspectRobot, KinematicsNeedNoWorkspace) {
  // A printer whose working mode was left out: forward kinematics hold, but no pose is reached both ways.
  const auto file = std::filesystem::temp_directory_path() / "telekerf-test-printer.toml";
  std::ofstream(file) << "[geometry]\nbase_radius_m = 0.13025\ntool_radius_m = 0\n"
                         "rod_length_m = [0.269, 0.269, 0.269]\nrail_angle_deg = [90, 210, 330]\n"
                         "attack_angle_deg = [90, 90, 90]\nassembly_mode = \"below\"\nstroke_m = [-1, 1]\n";
  const auto fk =
      json_of(inspect(file.string() + " --fk 0.231101645177054 0.233456816788892 0.261930399179169"));
  EXPECT_NEAR(fk.at("tool_m").at(0).get<double>(), 0.03, 1e-12);
  EXPECT_NEAR(fk.at("tool_m").at(2).get<double>(), 0.01, 1e-12);
  EXPECT_NE(one_sentence(inspect(file.string() + " --ik 0.03 -0.02 0.01")).find("working_mode"),
            std::string::npos);
  EXPECT_NE(one_sentence(inspect(file.string() + " --workspace")).find("working_mode"), std::string::npos);
  std::filesystem::remove(file);
}

TEST(InspectRobot, APictureOfNoKnownKindIsRefused) {
  EXPECT_NE(one_sentence(inspect("slave-keops --workspace --picture x.foo")).find("x.foo"),
            std::string::npos);
}

TEST(InspectRobot, HallCalibrationIsReported) {
  const auto out = json_of(inspect("slave-keops --hall"));
  EXPECT_GT(out.at("before").at("rms_m").get<double>(), 10 * out.at("after").at("rms_m").get<double>());
}

}  // namespace
