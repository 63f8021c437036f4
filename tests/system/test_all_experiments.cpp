// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment all: the same bytes again, what is there is not run again, and what changed is said.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "tests/system/programs.h"

namespace telekerf::integration {
namespace {

using std::chrono::seconds;
namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

fs::path file_with(const std::string& name, const std::string& text) {
  const fs::path file = Program::scratch() / name;
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
  return file;
}

/// By default two experiments that take a second each; returns what is said.
std::string run_all(const std::string& out, const std::vector<std::string>& more = {},
                    const std::string& only = "hall-sensor,space-contour") {
  std::vector<std::string> words{"all", "--quick", "--only", only, "--out", out};
  words.insert(words.end(), more.begin(), more.end());
  Program all("telekerf-experiment", words);
  EXPECT_EQ(all.wait(seconds(180)), 0) << all.output();
  return all.output();
}

TEST(AllExperiments, TwoRunsOfOneSeedAreTheSameBytesButForOneLine) {
  const fs::path a = Program::scratch() / "all-a", b = Program::scratch() / "all-b";
  // Of each kind one: gnuplot's figures, pictures, runs on several threads, stations over a link; some at a
  // time and one by one.
  const std::string kinds = "hall-sensor,space-contour,force-feedback,robots";
  run_all(a.string(), {"--jobs", "3"}, kinds);
  run_all(b.string(), {"--jobs", "1"}, kinds);
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(a)) {
    if (!entry.is_regular_file()) continue;
    const fs::path other = b / fs::relative(entry.path(), a);
    ++files;
    const std::vector<std::string> mine = lines_of(text_of(entry.path())), its = lines_of(text_of(other));
    ASSERT_EQ(mine.size(), its.size()) << other;
    int differ = 0;
    for (std::size_t i = 0; i < mine.size(); ++i) {
      if (mine[i] == its[i]) continue;
      ++differ;
      EXPECT_TRUE(mine[i].starts_with("<p class=\"made\">")) << other << ": " << mine[i].substr(0, 100);
    }
    EXPECT_LE(differ, entry.path().filename() == "report.html" ? 1 : 0) << other;
  }
  EXPECT_GT(files, 20);
  EXPECT_NE(text_of(a / "report.html").find("By the clock: hall-sensor "), std::string::npos);
}

TEST(AllExperiments, ThePageNeedsNothingBesideItAndIsSmall) {
  const fs::path out = Program::scratch() / "all-page";
  run_all(out.string());
  const std::string page = text_of(out / "report.html");
  EXPECT_LT(page.size(), 2u << 20);
  for (const char* outside : {"src=\"http", "href=\"http", "<link", "url(http"})
    EXPECT_EQ(page.find(outside), page.npos) << outside;
  EXPECT_FALSE(std::regex_search(page.substr(0, 20000), std::regex("\\{\\{[a-z_]+\\}\\}")))
      << "a place of the template";
  EXPECT_NE(page.find("Dygraph"), page.npos);
  EXPECT_NE(page.find("data:image/webp;base64,"), page.npos);
  EXPECT_NE(page.find("telekerf-experiment hall-sensor --seed 1"), page.npos) << "the command stands there";
  EXPECT_NE(page.find("not assessed: the experiment was not run"), page.npos);
}

TEST(AllExperiments, SaysWhatHasChangedAgainstAnotherRun) {
  const fs::path a = Program::scratch() / "all-seed-1", b = Program::scratch() / "all-seed-2";
  run_all(a.string());
  EXPECT_EQ(run_all(b.string(), {"--against", a.string()}).find("changed:"), std::string::npos);
  const std::string said = run_all(b.string(), {"--seed", "2", "--against", a.string()});
  EXPECT_NE(said.find("changed: 9.2-saddle: "), said.npos) << said;
  EXPECT_EQ(said.find("changed: 7.2.1-resolution"), said.npos) << "it has no seed";
  EXPECT_NE(text_of(b / "report.html").find("<h3>Against all-seed-1</h3>"), std::string::npos);
}

TEST(AllExperiments, WhatIsThereOfTheSameCommitIsNotRunAgain) {
  const fs::path out = Program::scratch() / "all-again";
  run_all(out.string());
  const auto claims = nlohmann::json::parse(text_of(out / "claims.json"));
  const std::string commit = claims.at("commit");
  const bool trusted = commit != "unknown" && !commit.ends_with("-changed");
  const std::string said = run_all(out.string());
  EXPECT_EQ(said.find("(was there)") != said.npos, trusted) << commit << ": " << said;
  // What was damaged since is run again.
  const fs::path folder = out / "results" / commit / "hall-sensor" / "1-quick";
  const std::string result = text_of(folder / "result.json");
  std::ofstream(folder / "result.json") << result.substr(0, 200);
  EXPECT_EQ(run_all(out.string()).find("hall-sensor (was there)"), std::string::npos);
  EXPECT_EQ(text_of(folder / "result.json"), result);
  // Half a run is none.
  fs::remove(out / "results" / commit / "hall-sensor" / "1-quick" / "done.json");
  EXPECT_EQ(run_all(out.string()).find("hall-sensor (was there)"), std::string::npos);
}

TEST(AllExperiments, WhatCannotBeDoneIsOneSentence) {
  for (const auto& [words, named] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--only", "nothing"}, "--only nothing: must be one of"},
           {{"--against", "/nowhere"}, "holds no claims.json"},
           {{"--against", file_with("other/claims.json", R"({"claims": [{"id": 3}]})").parent_path().string()}, "is none of this program's"},
           {{"--claims", file_with("none.toml", "").string()}, "holds no claim"}}) {
    std::vector<std::string> all{"all", "--out", (Program::scratch() / "never").string()};
    all.insert(all.end(), words.begin(), words.end());
    Program program("telekerf-experiment", all);
    EXPECT_EQ(program.wait(seconds(30)), 2) << program.output();
    EXPECT_NE(program.output().find(named), std::string::npos) << program.output();
    EXPECT_FALSE(fs::exists(Program::scratch() / "never"));
  }
}

}  // namespace
}  // namespace telekerf::integration
