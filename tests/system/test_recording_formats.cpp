// SPDX-License-Identifier: Apache-2.0
// A run in virtual time and its recording: played again, exported, and read by programs that are not ours.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <tuple>

#include "common/recording/run_reader.h"
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
    const Said said = run("telekerf-experiment", {"lap", "--record", "--duration-s", "6", "--netem", "wifi",
                                                  "--seed", "5", "--out", folder()});
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
  for (const char* file :
       {"report.json", "trace.csv", "master.csv", "slave.csv", "contour.csv", "master.json", "slave.json"})
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

TEST_F(RecordingFormats, AReplayRefusesWhatItsRecordingStandsFor) {
  const auto refusal = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"replay", folder()});
    const Said said = run("telekerf-experiment", words);
    EXPECT_EQ(said.code, 2) << said.text;
    return said.text;
  };
  for (const auto& [flag, value, of] :
       {std::tuple{"--image", "gear", "contour"}, std::tuple{"--width-mm", "60", "contour"},
        std::tuple{"--hand-speed-mm-s", "60", "hand"}, std::tuple{"--hand-sideways-n", "15", "hand"},
        std::tuple{"--control-hz", "2000", "hand"}})
    EXPECT_NE(refusal({flag, value}).find(std::string("no effect in a replay: its ") + of), std::string::npos)
        << flag;
  EXPECT_NE(refusal({"--quick"}).find("there is no --quick"), std::string::npos);
  EXPECT_NE(refusal({"--duration-s", "6.1"}).find("the hand is recorded for 6 s"), std::string::npos);
  // What the run had is no other question.
  const Said same =
      run("telekerf-experiment", {"replay", folder(), "--image", "heart", "--control-hz", "1000"});
  EXPECT_EQ(same.code, 0) << same.text;
  EXPECT_NE(same.text.find("the same bit by bit"), std::string::npos) << same.text;
}

TEST_F(RecordingFormats, AReplayLeavesTheRunAsItIs) {
  const std::string link = (Program::scratch() / "link").string();
  fs::remove(link);
  fs::create_directory_symlink(folder(), link);
  const std::string report = text_of(folder() + "/report.json");
  for (const std::string& out : {folder(), folder() + "/", folder() + "/inside", link, link + "/inside"}) {
    const Said said = run("telekerf-experiment", {"replay", folder(), "--law", "local", "--out", out});
    EXPECT_EQ(said.code, 2) << out;
    EXPECT_NE(said.text.find("the recorded run's own folder"), std::string::npos) << said.text;
  }
  const fs::path other = Program::scratch() / "other-run";
  fs::create_directories(other);
  std::ofstream(other / "report.json") << "{}";
  const std::vector<std::string> words{"replay", folder(), "--duration-s", "1", "--out", other.string()};
  EXPECT_EQ(run("telekerf-experiment", words).code, 2);
  EXPECT_EQ(text_of(other / "report.json"), "{}");
  EXPECT_EQ(text_of(folder() + "/report.json"), report);
  fs::remove(other / "report.json");
  for (int n = 0; n < 2; ++n)
    EXPECT_EQ(run("telekerf-experiment", words).code, 0) << "a replay's folder, again";
}

TEST_F(RecordingFormats, ADamagedFileIsOneLineOfTheListOfRuns) {
  const fs::path runs = Program::scratch() / "runs";
  for (const char* name : {"a-whole", "b-cut", "c-none", "d-whole"}) {
    fs::create_directories(runs / name);
    for (const char* file : {"master.h5", "slave.h5"})
      fs::copy_file(folder() + "/" + file, runs / name / file, fs::copy_options::overwrite_existing);
  }
  fs::resize_file(runs / "b-cut" / "slave.h5", fs::file_size(runs / "b-cut" / "slave.h5") / 2);
  std::ofstream(runs / "c-none" / "master.h5") << "no HDF5";
  const Said said = run("telekerf-inspect", {"runs", runs.string(), "--json"});
  ASSERT_EQ(said.code, 0) << said.text;
  const auto json = nlohmann::json::parse(said.text);
  ASSERT_EQ(json["runs"].size(), 4U);
  for (const auto& one : json["runs"]) {
    const std::string name = one["name"];
    const std::string damage = one["damage"];
    EXPECT_EQ(one["state"], name.ends_with("whole") ? "closed" : "damaged") << name;
    EXPECT_NEAR(one["seconds"].get<double>(), 6.0, 0.01) << name;
    EXPECT_EQ(damage.empty(), name.ends_with("whole")) << damage;
    if (name == "b-cut") {
      EXPECT_NE(damage.find("slave.h5: cannot be read"), std::string::npos) << damage;
    }
  }
  const Said list = run("telekerf-inspect", {"runs", runs.string()});
  EXPECT_EQ(list.code, 0);
  EXPECT_NE(list.text.find("master.h5: cannot be read as a recording: it is no HDF5 file"), std::string::npos)
      << list.text;
}

/// Of the table of docs/reference/recording.md: the groups, and whether a lap has them.
std::map<std::string, bool> documented_groups() {
  std::map<std::string, bool> groups;
  std::istringstream page(text_of(TELEKERF_SYSTEM_TESTS "/../../docs/reference/recording.md"));
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("| group | rows | by | of a lap |")) inside = true;
    if (line.empty()) inside = false;
    if (!inside || !line.starts_with("| `")) continue;
    std::istringstream names(line.substr(0, line.find(" |", 2)));
    for (std::string name; std::getline(names, name, '`') && std::getline(names, name, '`');)
      groups[name] = line.ends_with("| yes |");
  }
  return groups;
}

TEST_F(RecordingFormats, ALapRecordsWhatThePageSays) {
  std::set<std::string> there;
  for (const char* role : {"master", "slave"}) {
    const RunReader reader(fs::path(folder()) / (std::string(role) + ".h5"));
    for (const auto& series : reader.series()) there.insert(series.schema.name);
    if (!reader.contours().empty()) there.insert("contours");
    if (!reader.identity().words.empty()) there.insert("words");
    if (!reader.identity().figures.empty()) there.insert("figures");
  }
  const auto groups = documented_groups();
  EXPECT_EQ(groups.size(), 12U);
  for (const auto& [name, of_lap] : groups) EXPECT_EQ(there.contains(name), of_lap) << name;
  for (const std::string& name : there) EXPECT_TRUE(groups.contains(name)) << name << " is not on the page";
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
  const Said said = run(TELEKERF_OCTAVE, {"--no-gui", "--norc", "--eval",
                                          "run = load('" + folder() +
                                              "/slave.h5'); disp(size(run.slave.tool)); "
                                              "printf('%.9g\\n', max(abs(run.slave.tool(:))));"});
  EXPECT_EQ(said.code, 0) << said.text;
  EXPECT_NE(said.text.find("6000"), std::string::npos) << said.text;
#else
  GTEST_SKIP() << "no octave-cli when this was configured";
#endif
}

TEST_F(RecordingFormats, NoOutputTakesARecordingsPlace) {
  const fs::path own = Program::scratch() / "own";
  fs::create_directories(own);
  for (const char* file : {"master.h5", "slave.h5"}) fs::copy(folder() + "/" + file, own);
  const std::string before = text_of(own / "slave.h5");
  const std::string out = (Program::scratch() / "elsewhere").string();
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"run", own.string(), "--mcap", (own / "slave.h5").string(), "--out", out},
        {"run", own.string(), "--mcap", out + "/report.json", "--out", out},
        {"export", own.string(), "master.csv", "--out", (own / "slave.h5").string()}}) {
    const Said said = run("telekerf-inspect", words);
    EXPECT_EQ(said.code, 2) << said.text;
    EXPECT_NE(said.text.find("name another file"), std::string::npos) << said.text;
  }
  EXPECT_EQ(text_of(own / "slave.h5"), before);
}

/// Number of `bytes` octets at `at`, the lowest first.
std::uint64_t number_at(const std::string& text, std::size_t at, std::size_t bytes) {
  std::uint64_t number = 0;
  for (std::size_t n = bytes; n > 0; --n) number = number << 8U | static_cast<unsigned char>(text.at(at + n - 1));
  return number;
}

TEST_F(RecordingFormats, TheMcapOfAVirtualRunBeginsAtItsFirstMoment) {
  const std::string file = (Program::scratch() / "begins.mcap").string();
  const Said made = run("telekerf-inspect", {"run", folder(), "--mcap", file, "--out", Program::scratch().string()});
  ASSERT_EQ(made.code, 0) << made.text;
  const std::string mcap = text_of(file);
  // Behind the footer's head (9 octets) stands where the summary begins; statistics are record 0x0B of it.
  std::size_t at = number_at(mcap, mcap.size() - 8 - 20, 8);
  while (mcap.at(at) != 0x0B) at += 9 + number_at(mcap, at + 1, 8);
  constexpr std::size_t kStart = 9 + 8 + 2 + 4 + 4 + 4 + 4;
  EXPECT_LT(number_at(mcap, at + kStart, 8), 2'000'000U) << "ns";
  EXPECT_NEAR(static_cast<double>(number_at(mcap, at + kStart + 8, 8)), 6e9, 0.1e9);
}

TEST_F(RecordingFormats, AnIndependentReaderTakesTheMcap) {
  const std::string file = (Program::scratch() / "lap.mcap").string();
  const Said made =
      run("telekerf-inspect", {"run", folder(), "--mcap", file, "--out", Program::scratch().string()});
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
