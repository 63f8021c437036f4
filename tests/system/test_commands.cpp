// SPDX-License-Identifier: Apache-2.0
// The tools as an outsider calls them: what they cannot do is one sentence and exit code 2, and leaves
// nothing behind; what they print as JSON is one object.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/recording/run_record.h"
#include "tests/system/programs.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;
namespace fs = std::filesystem;

std::string file_of(const std::string& name, const std::string& text) {
  std::string path = (Program::scratch() / name).string();
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

struct Call {
  const char* name;
  const char* program;
  std::vector<std::string> words;
};

class Refused : public testing::TestWithParam<Call> {};

TEST_P(Refused, WithOneSentenceAndNothingLeft) {
  const std::string out = (Program::scratch() / GetParam().name / "out").string();
  std::vector<std::string> words = GetParam().words;
  words.insert(words.end(), {"--out", out});
  Program program(GetParam().program, words);
  EXPECT_EQ(program.wait(seconds(30)), 2) << program.output();
  const std::string said = program.output();
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  EXPECT_EQ(said.find("unexpected"), std::string::npos) << said;
  // The last two words are what is wrong: the option or its value is named.
  const std::string& value = GetParam().words.back();
  const std::string& option = GetParam().words[GetParam().words.size() - 2];
  EXPECT_TRUE(said.find(value.empty() ? "''" : value) != said.npos || said.find(option) != said.npos) << said;
  EXPECT_FALSE(fs::exists(out));
}

INSTANTIATE_TEST_SUITE_P(
    BadInput, Refused,
    testing::Values(
        Call{"DelayLaw", "telekerf-experiment", {"delay", "--law", "magic"}},
        Call{"DelayCodec", "telekerf-experiment", {"delay", "--codec", "magic"}},
        Call{"DelayEstimator", "telekerf-experiment", {"delay", "--estimator", "magic"}},
        Call{"DelayEmptyLaw", "telekerf-experiment", {"delay", "--law", ""}},
        Call{"LapEmptyImage", "telekerf-experiment", {"lap", "--image", ""}},
        Call{"DelayProfile", "telekerf-experiment", {"delay", "--netem", "mars"}},
        Call{"DelayNegativeLoss", "telekerf-experiment", {"delay", "--loss", "-0.5"}},
        Call{"ContourImage", "telekerf-experiment", {"closed-contour", "--image", "nowhere.png"}},
        Call{"ContourTooLarge",
             "telekerf-experiment",
             {"closed-contour", "--image", "circle", "--width-mm", "100"}},
        Call{"ContourTooSmall",
             "telekerf-experiment",
             {"closed-contour", "--image", "circle", "--width-mm", "0.05"}},
        Call{"SpaceTooSteep",
             "telekerf-experiment",
             {"space-contour", "--curvature-mm", "12", "--radius-mm", "15"}},
        Call{"SpaceTooLarge",
             "telekerf-experiment",
             {"space-contour", "--curvature-mm", "21", "--radius-mm", "19.5"}},
        Call{"ChaosWithoutTime", "telekerf-experiment", {"chaos", "--runs", "1", "--duration-s", "7.9"}},
        Call{"ChaosFault", "telekerf-experiment", {"chaos", "--faults", "gremlin"}},
        Call{"LapBeta", "telekerf-experiment", {"lap", "--beta", "0.01", "--width-mm", "40"}},
        Call{"KinematicsRobot", "telekerf-experiment", {"kinematics", "--robot", "nowhere.toml"}},
        Call{"CodecTrace", "telekerf-experiment", {"codec", "--seconds", "5", "--trace", "nowhere.csv"}},
        Call{"CodecRate", "telekerf-experiment", {"codec", "--rate-hz", "nan"}},
        Call{"PictureWidth", "telekerf-inspect", {"contour", "heart", "--width-mm", "nan"}},
        Call{"PictureTolerance", "telekerf-inspect", {"contour", "heart", "--tolerance-mm", "nan"}},
        Call{"PictureStart", "telekerf-inspect", {"contour", "heart", "--start", "nan,3"}},
        Call{"PictureSelect", "telekerf-inspect", {"contour", "heart", "--select", "-1"}}),
    [](const auto& call) { return std::string(call.param.name); });

TEST(Commands, AnEmptyFolderNameIsRefused) {
  Program contour("telekerf-inspect", {"contour", "heart", "--out", ""});
  EXPECT_EQ(contour.wait(seconds(30)), 2) << contour.output();
  EXPECT_NE(contour.output().find("out = '': must not be empty"), std::string::npos) << contour.output();
}

TEST(Commands, ARunWithoutAnythingFollowedHasNoFigures) {
  const std::string lost =
      file_of("lost.csv", "index,in_ns,out_ns,lost,duplicated,corrupted\r\n0,0,-1,1,0,0\r\n");
  const std::string out = (Program::scratch() / "lost").string();
  Program delay("telekerf-experiment", {"delay", "--netem", lost, "--out", out});
  EXPECT_EQ(delay.wait(seconds(60)), 1) << delay.output();
  const auto row = nlohmann::json::parse(std::ifstream(out + "/delay.json")).at("rows").at(0);
  for (const std::string figure : {"tracking_rmse_um", "tracking_max_um", "prediction_rmse_um", "settle_s"})
    EXPECT_TRUE(row.at(figure).is_null()) << figure;
  EXPECT_FALSE(row.at("stable").get<bool>());
  EXPECT_EQ(row.at("profile").get<std::string>(), "lost") << "results hold no path";
}

TEST(Commands, ResultsHoldNoPath) {
  const fs::path picture = Program::scratch() / "my circle.png";
  fs::copy_file(TELEKERF_BIN_DIR "/../share/telekerf/pictures/circle.png", picture,
                fs::copy_options::overwrite_existing);
  const std::string out = (Program::scratch() / "machined").string();
  Program contour("telekerf-experiment", {"closed-contour", "--image", picture.string(), "--out", out});
  ASSERT_EQ(contour.wait(seconds(150)), 0) << contour.output();
  const auto result = nlohmann::json::parse(std::ifstream(out + "/result.json"));
  EXPECT_EQ(result.at("image").get<std::string>(), "my circle.png");
  EXPECT_EQ(nlohmann::json::parse(contour.output()), result) << "one object on standard output";
}

TEST(Commands, TheMiddleOfARegionIsNoStroke) {
  const std::string out = (Program::scratch() / "region").string();
  Program open("telekerf-experiment",
               {"open-contour", "--image", "blob", "--speed-mm-s", "50", "--out", out});
  ASSERT_EQ(open.wait(seconds(60)), 0) << open.output();
  const auto result = nlohmann::json::parse(std::ifstream(out + "/result.json"));
  EXPECT_TRUE(result.at("closed").get<bool>()) << "its outline is what it has";
}

TEST(Commands, NamesThatAreNoUtf8DoNotStopAReport) {
  std::string samples =
      "gr\xf6\xdf"
      "e\n";
  for (int i = 0; i < 64; ++i) samples += std::to_string(i % 5) + "\n";
  Program codec("telekerf-inspect", {"codec", file_of("latin.csv", samples)});
  ASSERT_EQ(codec.wait(seconds(30)), 0) << codec.output();
  EXPECT_EQ(nlohmann::json::parse(codec.output()).at("samples").get<int>(), 64);
}

TEST(Commands, DescriptorsOfWhatIsNoPolygonAreRefused) {
  for (const std::string& file : {file_of("far.csv", "0,0\n1e300,0\n1,1e300\n"), Program::scratch().string(),
                                  std::string("nowhere.csv")}) {
    Program efd("telekerf-inspect", {"efd", file, "--harmonics", "2"});
    EXPECT_EQ(efd.wait(seconds(30)), 2) << efd.output();
    EXPECT_NE(efd.output().find(file), std::string::npos) << efd.output();
  }
}

TEST(Commands, ARunThatBurntBeyondTheCorridorEndsWithABadVerdict) {
  RunRecord record;
  record.contour_m = {{0, 0}, {10e-3, 0}, {20e-3, 0}};
  for (std::uint64_t tick = 0; tick < 20; ++tick) {
    record.slave.push_back({.tick = tick, .t_s = static_cast<double>(tick) * 1e-3, .laser_w = 4.0});
    record.slave.back().tool_m = {static_cast<double>(tick) * 1e-3, 0, 0};
    record.master.push_back({.tick = tick});
  }
  const auto verdict_on = [&] {
    const fs::path folder = Program::scratch() / "judged";
    write_contour(folder, record);
    write_master(folder, record);
    write_slave(folder, record);
    Program run("telekerf-inspect", {"run", folder.string()});
    const int code = run.wait(seconds(30));
    EXPECT_EQ(run.output().find("left the corridor") != std::string::npos, code == 1) << run.output();
    return code;
  };
  EXPECT_EQ(verdict_on(), 0);
  record.slave[7].tool_m[1] = 0.6e-3;
  EXPECT_EQ(verdict_on(), 1);
}

TEST(Commands, WhatIsNoRunIsNeitherListedNorExported) {
  const fs::path folder = Program::scratch() / "shelf";
  fs::create_directories(folder / "no-run");
  Program none("telekerf-inspect", {"runs", folder.string()});
  EXPECT_EQ(none.wait(seconds(30)), 0);
  EXPECT_NE(none.output().find("no recorded run"), std::string::npos) << none.output();
  Program nowhere("telekerf-inspect", {"runs", (folder / "nowhere").string()});
  EXPECT_EQ(nowhere.wait(seconds(30)), 2) << nowhere.output();
  Program exported("telekerf-inspect", {"export", (folder / "no-run").string(), "master.csv"});
  EXPECT_EQ(exported.wait(seconds(30)), 2);
  EXPECT_NE(exported.output().find("holds no recording of a run"), std::string::npos) << exported.output();
}

TEST(Commands, EachSaysItsVersion) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--version"}, {"lap", "--version"}, {"delay", "--version"}}) {
    Program experiment("telekerf-experiment", words);
    EXPECT_EQ(experiment.wait(seconds(30)), 0) << experiment.output();
    EXPECT_EQ(experiment.output(), TELEKERF_VERSION "\n");
  }
}

TEST(Commands, TheConstraintsTableDrivesTheHandAlongTheCurveThatItsRowNames) {
  const fs::path out = Program::scratch() / "constraint";
  Program program("telekerf-experiment", {"constraint", "--duration-s", "5", "--out", out.string()});
  ASSERT_LE(program.wait(seconds(100)), 1) << program.output();  // so short a run may miss a bar
  std::ifstream in(out / "constraint.json");
  const nlohmann::json table = nlohmann::json::parse(in).at("table");
  const auto driven_um = [&](const char* curve, int k) {
    for (const auto& row : table) {
      if (row.at("contour") == "rounded" && row.at("curve") == curve && row.at("k") == k)
        return row.at("driven_rms_um").get<double>();
    }
    throw std::out_of_range(curve);
  };
  // A chord for a curve is felt: 3.2 against 1.0 um.
  EXPECT_GT(driven_um("lines", 4), 2.5 * driven_um("circles", 4));
  EXPECT_GT(driven_um("descriptor", 1), 1.5 * driven_um("circles", 1));
}

TEST(Commands, AScaleThatIsNoNumberIsRefused) {
  Program ctl("telekerf-ctl", {"beta", "nan", "--domain", own_domain()});
  EXPECT_EQ(ctl.wait(seconds(30)), 2);
  EXPECT_NE(ctl.output().find("value = nan: must be a finite number"), std::string::npos) << ctl.output();
}

TEST(Commands, TheNameOfBeforeIsRefusedWithTheNewOne) {
  Program tell("telekerf-tell", {"stop"});
  EXPECT_EQ(tell.wait(seconds(30)), 2);
  EXPECT_NE(tell.output().find("telekerf-ctl"), std::string::npos) << tell.output();
}

}  // namespace
}  // namespace telekerf::integration
