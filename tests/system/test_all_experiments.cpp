// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment all: the same bytes again, what is there is not run again, and what changed is said.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
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
  int results = 0;
  for (const auto& entry : fs::recursive_directory_iterator(a / "results")) {
    if (entry.path().filename() != "result.json" && entry.path().filename() != "robots.json") continue;
    const auto json = nlohmann::json::parse(text_of(entry.path()));
    EXPECT_EQ(json.value("seed", 0), 1) << entry.path();
    EXPECT_FALSE(json.value("version", "").empty()) << entry.path();
    ++results;
  }
  EXPECT_GE(results, 3);
  EXPECT_NE(text_of(a / "report.html").find("By the clock: hall-sensor "), std::string::npos);
}

TEST(AllExperiments, ThePageNeedsNothingBesideItAndIsSmall) {
  const fs::path out = Program::scratch() / "all-page";
  run_all(out.string());
  const std::string page = text_of(out / "report.html");
  EXPECT_LT(page.size(), 2'000'000u);
  for (const char* outside : {"src=\"http", "href=\"http", "<link", "url(http"})
    EXPECT_EQ(page.find(outside), page.npos) << outside;
  EXPECT_FALSE(std::regex_search(page.substr(0, 20000), std::regex("\\{\\{[a-z_]+\\}\\}")))
      << "a place of the template";
  EXPECT_NE(page.find("Dygraph"), page.npos);
  EXPECT_NE(page.find("data:image/webp;base64,"), page.npos);
  EXPECT_NE(page.find("<code>./telekerf experiment hall-sensor --quick --seed 1</code>"), page.npos)
      << "the command stands there";
  EXPECT_NE(page.find("not assessed: the experiment was not run"), page.npos);
}

TEST(AllExperiments, CommandsOfThePageAreTakenAsTheyStandThere) {
  for (const bool quick : {true, false}) {
    const fs::path out = Program::scratch() / (quick ? "all-commands-quick" : "all-commands");
    std::vector<std::string> all{"all", "--only", "space-contour", "--out", out.string()};
    if (quick) all.emplace_back("--quick");
    Program one("telekerf-experiment", all);
    ASSERT_EQ(one.wait(seconds(120)), 0) << one.output();
    const std::string page = text_of(out / "report.html");
    static const std::regex kCommand("<code>\\./telekerf experiment ([^<]*)</code>");
    std::set<std::string> commands;
    for (std::sregex_iterator at(page.begin(), page.end(), kCommand), end; at != end; ++at)
      commands.insert((*at)[1]);
    EXPECT_GT(commands.size(), 10u);
    for (const std::string& line : commands) {
      std::istringstream in(line);
      std::vector<std::string> words{std::istream_iterator<std::string>(in), {}};
      EXPECT_EQ(std::count(words.begin(), words.end(), "--quick"), quick ? 1 : 0) << line;
      words.emplace_back("--print-config");
      Program program("telekerf-experiment", words);
      EXPECT_EQ(program.wait(seconds(30)), 0) << line << "\n" << program.output();
    }
  }
}

TEST(AllExperiments, EachTakesQuickSeedAndOutAndWhatIsGivenBesideQuickStays) {
  const auto configuration = [](const std::vector<std::string>& words) {
    Program program("telekerf-experiment", words);
    EXPECT_EQ(program.wait(seconds(30)), 0) << words[0] << "\n" << program.output();
    return "\n" + program.output();
  };
  for (const char* name : {"all", "autofocus", "chaos", "closed-contour", "codec", "constraint", "contours",
                           "delay", "hall-sensor", "haptics", "kinematics", "lap", "machine", "open-contour",
                           "pictures", "remote-machining", "robots", "space-contour"}) {
    const std::string said =
        configuration({name, "--quick", "--seed", "2", "--out", "elsewhere", "--print-config"});
    for (const char* line : {"\nquick = true\n", "\nseed = 2\n", "\nout = \"elsewhere\"\n"})
      EXPECT_NE(said.find(line), said.npos) << name << ": " << said;
  }
  EXPECT_NE(configuration({"robots", "--quick", "--print-config"}).find("\nruns = 5\n"), std::string::npos);
  // As many as a whole run has, but said.
  EXPECT_NE(configuration({"robots", "--quick", "--runs", "1000", "--print-config"}).find("\nruns = 1000\n"),
            std::string::npos);
  EXPECT_NE(configuration({"robots", "--print-config"}).find("\nruns = 1000\n"), std::string::npos);
  EXPECT_NE(configuration({"delay", "--quick", "--print-config"}).find("\nonly_rtt_ms = [100"),
            std::string::npos);
  // One run is short already.
  EXPECT_EQ(
      configuration({"delay", "--quick", "--rtt-ms", "50", "--print-config"}).find("\nonly_rtt_ms = [1"),
      std::string::npos);
  Program page("telekerf-experiment", {"codec", "--quick", "--page", "README.md"});
  EXPECT_EQ(page.wait(seconds(30)), 2);
  EXPECT_NE(page.output().find("--page: it is for figures of whole runs"), std::string::npos)
      << page.output();
}

TEST(AllExperiments, QuickAloneIsQuickOfAll) {
  const fs::path out = Program::scratch() / "all-and-one", alone = Program::scratch() / "robots-alone";
  run_all(out.string(), {}, "robots");
  Program robots("telekerf-experiment", {"robots", "--quick", "--out", alone.string()});
  EXPECT_EQ(robots.wait(seconds(120)), 0) << robots.output();
  const auto commit = *fs::directory_iterator(out / "results");
  const std::string of_all = text_of(commit.path() / "robots/1-quick/robots.json");
  EXPECT_FALSE(of_all.empty());
  EXPECT_EQ(text_of(alone / "robots.json"), of_all);
}

TEST(AllExperiments, SaysWhatHasChangedAgainstAnotherRun) {
  const fs::path a = Program::scratch() / "all-seed-1", b = Program::scratch() / "all-seed-2";
  run_all(a.string());
  const std::string same = run_all(b.string(), {"--against", a.string()});
  EXPECT_EQ(same.find("changed:"), same.npos) << same;
  EXPECT_NE(same.find(": no claim has another figure or verdict\n"), same.npos) << same;
  EXPECT_EQ(same.find("made otherwise"), same.npos) << same;
  EXPECT_TRUE(std::regex_search(same, std::regex("\n\\d of \\d claims held; \\d{3} are of experiments that "
                                                 "were not asked for: ")))
      << same;
  const std::string said = run_all(b.string(), {"--seed", "2", "--against", a.string()});
  EXPECT_NE(said.find("made otherwise (seed 1 -> 2)"), said.npos) << said;
  EXPECT_NE(text_of(b / "report.html").find("<b>Made otherwise</b> (seed 1 -&gt; 2)"), std::string::npos);
  EXPECT_NE(said.find("changed: 9.2-saddle: "), said.npos) << said;
  EXPECT_NE(text_of(b / "report.html").find("<h3>Against all-seed-1</h3>"), std::string::npos);
  // What was not run has not changed.
  EXPECT_EQ(run_all((Program::scratch() / "all-one").string(), {"--against", a.string()}, "hall-sensor")
                .find("changed:"),
            std::string::npos);
}

/// Processes whose command line holds the words.
std::vector<int> processes_with(const std::string& words) {
  std::vector<int> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != name.npos) continue;
    if (text_of(entry.path() / "cmdline").find(words) != std::string::npos) found.push_back(std::stoi(name));
  }
  return found;
}

TEST(AllExperiments, AnInterruptionEndsWhatRunsAndSaysWhatIsKept) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const fs::path out = Program::scratch() / ("all-interrupted-" + std::to_string(signal));
    // The first is there at once, the second takes a minute.
    Program all("telekerf-experiment",
                {"all", "--only", "space-contour,closed-contour", "--jobs", "2", "--out", out.string()});
    ASSERT_TRUE(all.says("space-contour (", seconds(60))) << all.output();
    ASSERT_EQ(processes_with(out.string()).size(), 2u) << "itself and the experiment";
    all.interrupt(signal);  // it alone, as kill and systemd do
    EXPECT_EQ(all.wait(seconds(10)), 130) << all.output();
    EXPECT_TRUE(processes_with(out.string()).empty());
    EXPECT_NE(
        all.output().find("interrupted: no page was written; 1 of 2 experiments are finished and kept in " +
                          out.string()),
        std::string::npos)
        << all.output();
    EXPECT_FALSE(fs::exists(out / "report.html"));
    const auto commit = *fs::directory_iterator(out / "results");
    EXPECT_TRUE(fs::exists(commit.path() / "space-contour/1/done.json"));
    EXPECT_FALSE(fs::exists(commit.path() / "closed-contour/1"));
  }
}

TEST(AllExperiments, TwoRunsDoNotWorkInOneFolder) {
  const fs::path out = Program::scratch() / "all-shared";
  Program first("telekerf-experiment", {"all", "--only", "closed-contour", "--out", out.string()});
  for (int i = 0; i < 200 && processes_with(out.string()).size() < 2; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const auto refused = [&] {
    Program second("telekerf-experiment", {"all", "--only", "space-contour", "--out", out.string()});
    EXPECT_EQ(second.wait(seconds(30)), 2) << second.output();
    EXPECT_NE(second.output().find("another run works there"), std::string::npos) << second.output();
  };
  refused();
  // An experiment that outlives its parent still does.
  first.kill();
  EXPECT_NE(first.wait(seconds(10)), 0);
  const std::vector<int> left = processes_with(out.string());
  ASSERT_FALSE(left.empty());
  refused();
  for (const int process : left) ::kill(process, SIGTERM);  // it may be drawing, by another process
}

TEST(AllExperiments, AManifestThatDoesNotFitIsRefused) {
  std::string manifest = text_of(fs::path(TELEKERF_SOURCE_DIR) / "experiments/report/claims.toml");
  const std::string out = (Program::scratch() / "all-misfit").string();
  const auto said_of = [&](const std::string& from, const std::string& to) {
    std::string changed = manifest;
    const std::size_t at = changed.find(from);
    EXPECT_NE(at, changed.npos) << from;
    changed.replace(at, from.size(), to);
    Program all("telekerf-experiment", {"all", "--quick", "--only", "space-contour", "--out", out, "--claims",
                                        file_with("misfit.toml", changed).string()});
    EXPECT_EQ(all.wait(seconds(60)), 2) << all.output();
    EXPECT_FALSE(fs::exists(fs::path(out) / "report.html"));
    return all.output();
  };
  std::string said = said_of("/saddle/normal_error_um/rms", "/sadle/normal_error_um/rms");
  EXPECT_NE(said.find("pointer = \"/sadle/normal_error_um/rms\": claim 9.2-saddle: nothing stands there"),
            said.npos)
      << said;
  said = said_of("space-contour.png", "space-contours.png");
  EXPECT_NE(
      said.find("file = \"space-contours.png\": space-contour leaves no such picture; name one of those"),
      said.npos)
      << said;
  said = said_of("reference = \"9.2\"\nresult = \"result.json\"",
                 "reference = \"9.2\"\nresult = \"results.json\"");
  EXPECT_NE(said.find("result = \"results.json\": space-contour leaves no such JSON file; name one of those "
                      "that it leaves: result.json"),
            said.npos)
      << said;
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
           {{"--against",
             file_with("other/claims.json", R"({"seed": 1, "quick": true, "claims": [{"id": 3}]})")
                 .parent_path()
                 .string()},
            "claims.0.id = 3: must be a word; no run writes that: name the --out of another run"},
           {{"--claims", file_with("none.toml", "").string()}, "holds no claim"},
           {{"--out", file_with("taken/results", "a file").parent_path().string()},
            "taken/results is no folder; name another"}}) {
    std::vector<std::string> all{"all"};
    if (words[0] != "--out") all.insert(all.end(), {"--out", (Program::scratch() / "never").string()});
    all.insert(all.end(), words.begin(), words.end());
    Program program("telekerf-experiment", all);
    EXPECT_EQ(program.wait(seconds(30)), 2) << program.output();
    EXPECT_NE(program.output().find(named), std::string::npos) << program.output();
    EXPECT_FALSE(fs::exists(Program::scratch() / "never"));
  }
}

}  // namespace
}  // namespace telekerf::integration
