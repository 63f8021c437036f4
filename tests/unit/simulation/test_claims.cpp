// SPDX-License-Identifier: Apache-2.0
// Claims: read, found in results, judged, held against another run's; and the shipped manifest.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "common/runtime/startup_error.h"
#include "experiments/report/fit.h"
#include "experiments/report/judgement.h"
#include "experiments/report/page_marks.h"

namespace telekerf::experiments {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

const fs::path kManifest = fs::path(TELEKERF_SOURCE_DIR) / "experiments/report/claims.toml";

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

fs::path file_with(const std::string& text) {
  const fs::path file = fs::path(testing::TempDir()) / ("claims-" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << text;
  return file;
}

const std::string kExperiment =
    "[[experiment]]\nname = \"lap\"\ntitle = \"t\"\nreference = \"8\"\nresult = \"r.json\"\n";
std::string claim(const std::string& id, const std::string& more) {
  return "[[claim]]\nid = \"" + id +
         "\"\nexperiment = \"lap\"\nstatement = \"s\"\nquantity = \"q\"\npointer = \"/a\"\n" + more;
}

TEST(Select, GoesByKeysPlacesAndMembers) {
  const auto json = ordered_json::parse(
      R"({"a": {"b": [{"x": 1, "law": "one", "v": 5}, {"x": 2, "law": "two", "v": 7.5, "w": 1},
      {"x": 2, "law": "three", "v": 8, "w": 1}]},
      "yes": true, "none": null, "word": "w"})");
  EXPECT_EQ(select(json, "/a/b/1/v"), 7.5);
  EXPECT_EQ(select(json, "/a/b/law=two/v"), 7.5);
  EXPECT_EQ(select(json, "/a/b/x=1&law=one/v"), 5.0);
  EXPECT_EQ(select(json, "/a/b/x=2&law=three/v"), 8.0);
  EXPECT_FALSE(select(json, "/a/b/x=2/v")) << "there are two of them";
  EXPECT_EQ(select(json, "/yes"), 1.0);
  for (const char* nothing :
       {"/a/b/x=1&law=two/v", "/a/b/3/v", "/a/c", "/none", "/word", "/a/b/1v/v", "/yes/x"})
    EXPECT_FALSE(select(json, nothing)) << nothing;
}

TEST(Judge, HeldNotHeldAndNotAssessed) {
  const Manifest manifest = load_manifest(file_with(
      kExperiment + claim("within", "relation = \"within\"\nbound = 2.0\ntolerance = 0.1\nfactor = 1000\n") +
      claim("below", "relation = \"at_most\"\nbound = 0.001\n") +
      claim("above", "relation = \"at_least\"\nbound = 3\n") + claim("long", "bound = 1\nquick = false\n")));
  const auto verdicts = [&](const ResultsByName& results, bool quick = false) {
    std::string out;
    for (const Judged& row : judge(manifest, results, quick)) out += verdict_text(row.verdict) + ",";
    return out;
  };
  EXPECT_EQ(verdicts({{"lap", {{"a", 0.00205}}}}), "held,not held,not held,held,");
  EXPECT_EQ(verdicts({{"lap", {{"a", 0.0018}}}}), "not held,not held,not held,held,");
  EXPECT_EQ(verdicts({{"lap", {{"a", 3.0}}}}, true), "not held,not held,held,not assessed,");
  EXPECT_EQ(verdicts({{"lap", {{"a", nullptr}}}}), "not assessed,not assessed,not assessed,not assessed,");
  EXPECT_EQ(verdicts({}), "not assessed,not assessed,not assessed,not assessed,");
}

TEST(Judge, AMissByLittleDoesNotReadAsHeld) {
  const auto words = [](const std::string& relation, double value) {
    const Manifest manifest = load_manifest(file_with(kExperiment + claim("c", relation)));
    return value_text(judge(manifest, {{"lap", {{"a", value}}}}, false).front());
  };
  EXPECT_EQ(words("relation = \"at_most\"\nbound = 1\n", 1.003), "1.003");
  EXPECT_EQ(words("relation = \"at_most\"\nbound = 1\n", 0.99996), "1");
  EXPECT_EQ(words("relation = \"at_most\"\nbound = 1\n", 1.04), "1.04");
  EXPECT_EQ(words("relation = \"at_least\"\nbound = 99.5\n", 99.4996), "99.4996");
}

TEST(Judge, WhatIsKnownToMissDoesNotFailTheRun) {
  const auto all = [&](const char* more) {
    const Manifest manifest =
        load_manifest(file_with(kExperiment + claim("a", std::string("bound = 1\n") + more)));
    return all_held(judge(manifest, {{"lap", {{"a", 2.0}}}}, false));
  };
  EXPECT_FALSE(all(""));
  EXPECT_TRUE(all("negative = true\n"));
}

TEST(Judge, SaysWhatChangedAndByHowMuch) {
  const Manifest manifest = load_manifest(file_with(kExperiment + claim("a", "bound = 1\nunit = \"um\"\n")));
  const auto row = [&](ordered_json value) { return judge(manifest, {{"lap", {{"a", value}}}}, false); };
  const ordered_json before = claims_json(row(0.8));
  EXPECT_TRUE(differences(row(0.8), before).empty());
  EXPECT_EQ(differences(row(1.2), before),
            std::vector<std::string>{"a: 0.8 -> 1.2 um (+50 %), held -> not held"});
  EXPECT_EQ(differences(row(nullptr), before), std::vector<std::string>{"a: 0.8 -> -, held -> not assessed"});
  EXPECT_EQ(differences(row(0.8), ordered_json::array()), std::vector<std::string>{"a: new"});
  EXPECT_EQ(differences({}, before), std::vector<std::string>{"a: gone"});
}

TEST(Manifest, WhatIsWrongIsNamed) {
  const auto complaint = [](const std::string& text) -> std::string {
    try {
      load_manifest(file_with(text));
    } catch (const StartupError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(complaint(kExperiment + claim("a", "bound = 1\n") + claim("a", "bound = 1\n")).find("claim.1.id"),
            std::string::npos);
  EXPECT_NE(complaint(claim("a", "bound = 1\n")).find("claim.0.experiment"), std::string::npos);
  EXPECT_NE(complaint(kExperiment + claim("a", "")).find("bound"), std::string::npos);
  EXPECT_NE(complaint(kExperiment + claim("a", "bound = 1\nbond = 2\n")).find("bond"), std::string::npos);
}

TEST(Manifest, WhatMakesAFigureMeaninglessIsRefused) {
  const auto complaint = [](const std::string& more) -> std::string {
    try {
      load_manifest(file_with(kExperiment + claim("a", "bound = 1\n") + claim("b", more)));
    } catch (const StartupError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint("bound = 1\nfactor = 0.5\n"), "");
  EXPECT_NE(complaint("bound = 1\nfactor = 0\n").find("claim.1.factor = 0: must not be 0"),
            std::string::npos);
  EXPECT_EQ(complaint("bound = 1\nrelation = \"within\"\ntolerance = 0\n"), "");
  EXPECT_NE(complaint("bound = 1\nrelation = \"within\"\n")
                .find("claim.1.tolerance: is what relation = \"within\" wants"),
            std::string::npos);
  EXPECT_NE(complaint("bound = 1\ntolerance = 0.1\n").find("claim.1.tolerance = 0.1: is of relation"),
            std::string::npos);
}

/// A folder as the experiment "lap" leaves it, and what is said of a manifest held against it.
class Fit : public testing::Test {
 protected:
  Fit() : folder_(fs::path(testing::TempDir()) / ("fit-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "r.json") << R"({"a": 1, "b": {"c": null, "d": "word"}})";
    std::ofstream(folder_ / "f.png") << "drawn";
  }
  ~Fit() override { fs::remove_all(folder_); }

  std::string complaint(const std::string& text, bool quick = false, int code = 0) const {
    const Manifest manifest = load_manifest(file_with(text));
    const std::vector<Finished> finished{{.name = "lap", .folder = folder_, .code = code, .complaint = {}}};
    try {
      require_fit(manifest, finished, read_results(manifest, finished), quick);
    } catch (const StartupError& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
};

std::string claim_at(const std::string& pointer, const std::string& more = "") {
  return "[[claim]]\nid = \"x\"\nexperiment = \"lap\"\nstatement = \"s\"\nquantity = \"q\"\nbound = "
         "1\npointer = \"" +
         pointer + "\"\n" + more;
}

TEST_F(Fit, PlacesInTheResult) {
  EXPECT_EQ(complaint(kExperiment + claim_at("/a")), "");
  EXPECT_EQ(complaint(kExperiment + claim_at("/b/c")), "") << "nothing was measured there";
  EXPECT_EQ(complaint(kExperiment + claim_at("/b/c/further")), "");
  const std::string nowhere = complaint(kExperiment + claim_at("/b/e"));
  EXPECT_NE(nowhere.find(".toml: claim.0.pointer = \"/b/e\": claim x: nothing stands there, or more than one "
                         "thing, in lap's r.json"),
            nowhere.npos)
      << nowhere;
  const std::string word = complaint(kExperiment + claim_at("/b/d"));
  EXPECT_NE(word.find("claim.0.pointer = \"/b/d\": claim x: what stands there in lap's r.json is no number"),
            word.npos)
      << word;
  // What a short run does not have is asked of a full one alone.
  EXPECT_EQ(complaint(kExperiment + claim_at("/b/e", "quick = false\n"), true), "");
  EXPECT_NE(complaint(kExperiment + claim_at("/b/e"), true).find("say quick = false"), std::string::npos);
  EXPECT_NE(complaint(kExperiment + claim_at("/b/e", "quick = false\n"), false), "");
  EXPECT_EQ(complaint(kExperiment + claim_at("/b/e"), false, 2), "")
      << "it could not be run: that is said elsewhere";
}

TEST_F(Fit, ResultsAndFigures) {
  const std::string said =
      complaint("[[experiment]]\nname = \"lap\"\ntitle = \"t\"\nreference = \"8\"\nresult = \"s.json\"\n");
  EXPECT_NE(said.find("experiment.0.result = \"s.json\": lap leaves no such JSON file; name one of those "
                      "that it leaves: r.json"),
            said.npos)
      << said;
  const auto figure = [](const std::string& file, const std::string& more = "") {
    return kExperiment + "[[figure]]\nexperiment = \"lap\"\ncaption = \"c\"\nfile = \"" + file + "\"\n" +
           more;
  };
  EXPECT_EQ(complaint(figure("f.png")), "");
  const std::string missing = complaint(figure("g.png"));
  EXPECT_NE(
      missing.find(
          "figure.0.file = \"g.png\": lap leaves no such picture; name one of those that it leaves: f.png"),
      missing.npos)
      << missing;
  EXPECT_EQ(complaint(figure("g.png", "quick = false\n"), true), "");
  EXPECT_NE(complaint(figure("g.png", "quick = false\n"), false), "");
}

TEST(Manifest, EveryFigureOfChapterEightHasItsPanels) {
  const Manifest manifest = load_manifest(kManifest);
  std::string captions;
  for (const ManifestFigure& figure : manifest.figures) captions += figure.caption + "\n";
  // 8.9 is a photograph of the platform.
  for (const char* number : {"8.1", "8.2", "8.3", "8.4", "8.5", "8.6", "8.7", "8.8", "8.10", "8.11", "8.12"})
    EXPECT_NE(captions.find(std::string("igure ") + number), captions.npos) << number;
}

TEST(Manifest, EveryPageOfResultsHasClaims) {
  const Manifest manifest = load_manifest(kManifest);
  std::set<std::string> experiments;
  for (const Claim& one : manifest.claims) experiments.insert(one.experiment);
  for (const char* name :
       {"autofocus", "chaos", "compression", "constraint", "closed-contour", "delay", "robots"})
    EXPECT_TRUE(experiments.contains(name)) << name;
  for (const ManifestExperiment& one : manifest.experiments)
    EXPECT_TRUE(experiments.contains(one.name)) << one.name << " is run and nothing is claimed of it";
}

/// The columns that no run changes.
TEST(Readme, ItsMainTableIsTheManifests) {
  const auto rows = reporting::read_table(fs::path(TELEKERF_SOURCE_DIR) / "README.md", "headline");
  const auto fresh =
      reporting::read_rows(headline_table(judge(load_manifest(kManifest), {}, false)).markdown);
  ASSERT_EQ(rows.size(), fresh.size()) << "telekerf-experiment all --source . writes it anew";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const std::size_t column : {0, 1, 2, 4}) EXPECT_EQ(rows[i][column], fresh[i][column]) << i;
    if (i == 0) continue;
    EXPECT_EQ(rows[i][3].substr(0, rows[i][3].rfind(": ")), fresh[i][3].substr(0, fresh[i][3].rfind(": ")))
        << i;
    EXPECT_NE(rows[i][5], "not assessed") << rows[i][1] << ": written from a short run";
  }
}

TEST(Page, TheOneThatIsShippedIsSmallAndOfAWholeRun) {
  const fs::path page = fs::path(TELEKERF_SOURCE_DIR) / "docs/results/report.html";
  EXPECT_GT(fs::file_size(page), 1'000'000u) << "telekerf-experiment all --source . writes it";
  EXPECT_LT(fs::file_size(page), 2'000'000u);
}

TEST(Page, FiguresInProseBecomeTheClaimsToAsManyDecimals) {
  const Manifest manifest =
      load_manifest(file_with(kExperiment + claim("a", "bound = 1\n") + claim("b", "bound = 1\n")));
  const auto judged = judge(manifest, {{"lap", {{"a", 1234.567}}}}, false);
  EXPECT_EQ(with_figures("was 9.0<!-- claim a --> um, 1,000<!-- claim a -->, 5<!-- claim a -->.", judged),
            "was 1230.0<!-- claim a --> um, 1,230<!-- claim a -->, 1230<!-- claim a -->.");
  const std::string none = "9.0<!-- claim c --> um, 9.0<!-- cell a: b; c --> um, 9.0 <!-- claim a -->";
  EXPECT_EQ(with_figures(none, judged), none);
  EXPECT_EQ(with_figures("9.0<!-- claim b -->", judge(manifest, {}, false)), "9.0<!-- claim b -->");
}

TEST(Page, TheTemplateHoldsNoFigureOfItsOwn) {
  std::string page = text_of(fs::path(TELEKERF_SOURCE_DIR) / "experiments/report/page.html");
  const std::size_t body = page.find("<body>");
  page = page.substr(body, page.find("<script>") - body);
  page = std::regex_replace(page, std::regex("<[^>]*>"), "");
  static const std::regex kNumber(R"((?:^|[^\w])\d+(?:\.\d+)?)");
  for (std::sregex_iterator at(page.begin(), page.end(), kNumber), end; at != end; ++at)
    EXPECT_EQ(at->str().substr(at->str().find_first_of("0123456789")), "8")
        << "the chapter is all that may be said";
}

}  // namespace
}  // namespace telekerf::experiments
