// SPDX-License-Identifier: Apache-2.0
// A run in virtual time and its recording: played again, exported, and read by programs that are not ours.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/system/programs.h"

namespace telekerf::integration {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Said {
  int code;
  std::string text;
};

Said run(const std::string& program, const std::vector<std::string>& words) {
  Program running(program, words);
  const int code = running.wait(seconds(100));
  return {code, running.output()};
}

class RecordingFormats : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder() = (Program::scratch() / "lap").string();
    const Said said = run("telekerf-experiment", {"lap", "--record", "--duration-s", "6", "--netem", "wifi", "--seed",
                                                  "5", "--out", folder()});
    ASSERT_EQ(said.code, 0) << said.text;
  }
  static std::string& folder() {
    static std::string place;
    return place;
  }
};

TEST_F(RecordingFormats, TheReportFromTheRecordingIsThatOfTheRun) {
  const std::string out = (Program::scratch() / "report").string();
  const std::string bare = (Program::scratch() / "bare").string();
  fs::create_directories(bare);
  for (const char* file : {"master.h5", "slave.h5"}) fs::copy(folder() + "/" + file, bare);
  const Said said = run("telekerf-inspect", {"run", bare, "--out", out, "--csv"});
  ASSERT_EQ(said.code, 0) << said.text;
  for (const char* file : {"report.json", "trace.csv", "master.csv", "slave.csv", "contour.csv", "master.json", "slave.json"})
    EXPECT_EQ(text_of(fs::path(out) / file), text_of(fs::path(folder()) / file)) << file;
}

TEST_F(RecordingFormats, AReplayIsTheSameBitByBit) {
  const std::string out = (Program::scratch() / "again").string();
  const Said said = run("telekerf-experiment", {"replay", folder(), "--out", out});
  EXPECT_EQ(said.code, 0) << said.text;
  const auto json = nlohmann::json::parse(text_of(out + "/replay.json"));
  EXPECT_TRUE(json["identical"].get<bool>()) << json.dump(2);
  EXPECT_EQ(json["master"]["replayed"], 6000);
  EXPECT_EQ(text_of(out + "/report.json"), text_of(folder() + "/report.json"));
}

TEST_F(RecordingFormats, AReplayWithAnotherLawLeavesTheHandAsItWas) {
  const std::string out = (Program::scratch() / "what-if").string();
  const Said said = run("telekerf-experiment", {"replay", folder(), "--law", "local", "--out", out});
  EXPECT_EQ(said.code, 0) << said.text;
  const auto json = nlohmann::json::parse(text_of(out + "/replay.json"));
  EXPECT_FALSE(json["identical"].get<bool>());
  EXPECT_EQ(json["master"]["tool_max_um"], 0.0) << "the hand's place";
  EXPECT_GT(json["slave"]["tool_max_um"].get<double>(), 0.0);
  EXPECT_EQ(nlohmann::json::parse(text_of(out + "/report.json"))["law"], "local");
  EXPECT_EQ(run("telekerf-experiment", {"replay", folder(), "--law", "none"}).code, 2);
  EXPECT_EQ(run("telekerf-experiment", {"replay", Program::scratch().string()}).code, 2);
}

#ifdef TELEKERF_H5DUMP
TEST_F(RecordingFormats, H5dumpOpensIt) {
  const Said said = run(TELEKERF_H5DUMP, {"-d", "/slave/settled", folder() + "/slave.h5"});
  EXPECT_EQ(said.code, 0) << said.text;
  EXPECT_NE(said.text.find("( 6000 ) / ( H5S_UNLIMITED )"), std::string::npos) << said.text.substr(0, 500);
}
#endif

#ifdef TELEKERF_PYTHON_H5
TEST_F(RecordingFormats, H5pyOpensIt) {
  for (const char* role : {"master", "slave"}) {
    const Said said = run(TELEKERF_PYTHON_H5, {TELEKERF_SYSTEM_TESTS "/read_recording.py", folder(), role});
    EXPECT_EQ(said.code, 0) << said.text;
    EXPECT_NE(said.text.find("6000 rows"), std::string::npos) << said.text;
  }
}
#endif

TEST_F(RecordingFormats, OctaveOpensIt) {
#ifdef TELEKERF_OCTAVE
  const Said said =
      run(TELEKERF_OCTAVE, {"--no-gui", "--norc", "--eval",
                            "run = load('" + folder() + "/slave.h5'); disp(size(run.slave.tool)); "
                            "printf('%.9g\\n', max(abs(run.slave.tool(:))));"});
  EXPECT_EQ(said.code, 0) << said.text;
  EXPECT_NE(said.text.find("6000"), std::string::npos) << said.text;
#else
  GTEST_SKIP() << "no octave-cli when this was configured";
#endif
}

TEST_F(RecordingFormats, AnIndependentReaderTakesTheMcap) {
  const std::string file = (Program::scratch() / "lap.mcap").string();
  const Said made = run("telekerf-inspect", {"run", folder(), "--mcap", file, "--out", Program::scratch().string()});
  ASSERT_EQ(made.code, 0) << made.text;
#ifdef TELEKERF_NODE
  const Said said = run(TELEKERF_NODE, {TELEKERF_SYSTEM_TESTS "/read_mcap.mjs", TELEKERF_NODE_MODULES, file});
  ASSERT_EQ(said.code, 0) << said.text;
  const auto json = nlohmann::json::parse(said.text);
  EXPECT_EQ(json["topics"]["/master/rows"]["messages"], 6000);
  EXPECT_EQ(json["topics"]["/slave/rows"]["messages"], 6000);
  EXPECT_EQ(json["topics"]["/slave/rows"]["schema"], "telekerf/msg/SlaveRow");
  EXPECT_EQ(json["topics"]["/master/contour"]["messages"], 1);
#else
  GTEST_SKIP() << "no node with @mcap/core when this was configured (TELEKERF_NODE_MODULES)";
#endif
}

}  // namespace
}  // namespace telekerf::integration
