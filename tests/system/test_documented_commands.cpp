// SPDX-License-Identifier: Apache-2.0
// The commands of README and docs: each experiment is run in a short form, of every other program the
// settings are loaded, so that a flag, a name or a value that is gone is noticed.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "tests/system/programs.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

const fs::path kRoot = TELEKERF_SOURCE_DIR;

Words words_of(const std::string& line) {
  std::istringstream in(line);
  return {std::istream_iterator<std::string>(in), {}};
}

/// Lines of code blocks, and code within lines, that begin with one of our programs; `...` and what a shell
/// does with the rest are left out.
std::set<std::string> commands_of(const std::string& page) {
  static const std::regex kCommand(
      R"re((?:^|\n|`)((?:build/bin/telekerf-[a-z]+|\./telekerf (?:experiment|machine|demo))[^`\n]*))re");
  std::set<std::string> found;
  for (std::sregex_iterator at(page.begin(), page.end(), kCommand), end; at != end; ++at) {
    std::string line = (*at)[1];
    line = line.substr(0, line.find_first_of("#>&|"));
    found.insert(line.substr(0, line.find_last_not_of(' ') + 1));
  }
  return found;
}

/// A synopsis or an example of a file, device or word that is the reader's.
bool is_the_readers(const std::string& line) {
  static const std::regex kTheirs(
      R"([A-Z]{2,}|\b[N]\b|\[|\.\.\.|mine:|my-|unit\.toml|cell\.toml|leo\.csv|trace\.csv|force\.csv|run run|golomb|replay )");
  return std::regex_search(line, kTheirs);
}

std::set<std::string> documented() {
  std::set<std::string> all;
  const auto add = [&](const fs::path& file) {
    std::ifstream in(file);
    std::stringstream text;
    text << in.rdbuf();
    all.merge(commands_of(text.str()));
  };
  add(kRoot / "README.md");
  add(kRoot / "netem/README.md");
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "docs"))
    if (entry.path().extension() == ".md") add(entry.path());
  std::erase_if(all, is_the_readers);
  return all;
}

/// What makes an experiment short.
const std::map<std::string, Words> kShort{
    {"all", {"--only", "hall-sensor"}},
    {"autofocus", {"--starts", "1"}},
    {"chaos", {"--runs", "2"}},
    {"closed-contour", {"--image", "circle", "--speed-mm-s", "50"}},
    {"codec", {"--seconds", "5"}},
    {"constraint", {"--duration-s", "5"}},
    {"contours", {}},
    {"delay", {"--rtt-ms", "100", "--duration-s", "3"}},
    {"hall-sensor", {}},
    {"haptics", {"--hands", "1", "--runs", "20"}},
    {"lap", {"--duration-s", "5"}},
    {"machine", {"--image", "line"}},
    {"open-contour", {"--image", "line", "--speed-mm-s", "50"}},
    {"pictures", {"--netem", "lan", "--seeds", "1", "--duration-s", "2"}},
    {"remote-machining", {"--netem", "ideal", "--duration-s", "5"}},
    {"robots", {"--runs", "2"}},
    {"space-contour", {}}};

/// Pages stay as they are, and files go where the test's are.
Words shortened(Words words, const std::string& experiment, const std::string& out) {
  for (auto at = words.begin(); at != words.end();) {
    const bool elsewhere = *at == "--out" || *at == "--page" || *at == "--source" || *at == "--only-rtt-ms";
    at = elsewhere ? words.erase(at, at + 2) : at + 1;
  }
  const Words& more = kShort.at(experiment);
  words.insert(words.end(), more.begin(), more.end());
  words.insert(words.end(), {"--out", out});
  return words;
}

TEST(DocumentedCommands, EveryExperimentRunsInAShortForm) {
  int run = 0;
  for (const std::string& line : documented()) {
    Words words = words_of(line);
    const bool by_script = words.size() > 1 && words[0] == "./telekerf" && words[1] == "experiment";
    if (!by_script && words[0] != "build/bin/telekerf-experiment") continue;
    words.erase(words.begin(), words.begin() + (by_script ? 2 : 1));
    if (words.empty()) continue;
    ASSERT_TRUE(kShort.contains(words[0])) << line << ": has no short form here";
    const std::string out = (Program::scratch() / ("documented-" + std::to_string(run++))).string();
    Program program("telekerf-experiment", shortened(words, words[0], out));
    // So short a run may miss a bar.
    EXPECT_LE(program.wait(seconds(150)), 1) << line << "\n" << program.output();
    EXPECT_TRUE(fs::exists(out)) << line;
  }
  EXPECT_GT(run, 10);
}

TEST(DocumentedCommands, EveryOtherProgramTakesItsSettings) {
  int run = 0;
  for (const std::string& line : documented()) {
    Words words = words_of(line);
    const std::string name = fs::path(words[0]).filename().string();
    static const std::set<std::string> kStations{"telekerf-master", "telekerf-slave", "telekerf-vision",
                                                 "telekerf-console"};
    if (!kStations.contains(name)) continue;
    words.erase(words.begin());
    if (std::find(words.begin(), words.end(), "--print-config") == words.end())
      words.push_back("--print-config");
    Program program(name, words);
    EXPECT_EQ(program.wait(seconds(30)), 0) << line << "\n" << program.output();
    ++run;
  }
  EXPECT_GT(run, 10);
}

TEST(DocumentedCommands, AFlagThatIsGoneIsNoticed) {
  const auto found = commands_of(
      "see `build/bin/telekerf-slave --netem leo`:\n\n```\nbuild/bin/telekerf-experiment lap --gone 1   # "
      "so\n```\n");
  EXPECT_EQ(found, (std::set<std::string>{"build/bin/telekerf-slave --netem leo",
                                          "build/bin/telekerf-experiment lap --gone 1"}));
  Program lap("telekerf-experiment",
              shortened(words_of("lap --gone 1"), "lap", (Program::scratch() / "gone").string()));
  EXPECT_EQ(lap.wait(seconds(30)), 2);
  EXPECT_TRUE(is_the_readers("build/bin/telekerf-netem tc PROFILE --dev eth0"));
  EXPECT_FALSE(is_the_readers("build/bin/telekerf-experiment lap"));
}

}  // namespace
}  // namespace telekerf::integration
