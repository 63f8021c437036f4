// SPDX-License-Identifier: Apache-2.0
// Figures in prose: each comes from a claim, from a generated table, or has a reason to be typed.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/structure/breaches.h"
#include "tests/structure/rules.h"

namespace telekerf::structure {
namespace {

std::string shipped_list() {
  std::ifstream in(std::filesystem::path(TELEKERF_SOURCE_DIR) / "tests/structure/typed_numbers.txt");
  return {std::istreambuf_iterator<char>(in), {}};
}

/// What is said of a page that says `prose`, with a table and a claim to refer to.
Breaches said_of(const std::string& prose, const std::string& list = "") {
  Repository repository;
  repository.files["docs/results/claims.md"] =
      "<!-- table claims -->\n\n| claim | our figure | verdict |\n| --- | --- | --- |\n"
      "| fast | tracking at 100 ms: 0.678 um | held |\n| none | count: 0 | held |\n\n<!-- end of claims "
      "-->\n";
  repository.files["docs/results/page.md"] =
      "# Page\n\n" + prose +
      "\n\n## Tables\n\n<!-- table t -->\n\n| law | estimator | 0 | 5 ms |\n"
      "| --- | --- | --- | --- |\n| a | b | 1.25 / 7 | 33 |\n\n<!-- end of t -->\n";
  repository.files["tests/unit/test_it.cpp"] = "TEST(Thing, HoldsIt) {}";
  return typed_numbers(repository, list);
}

TEST(TypedNumbers, NoneStandsOnAPageWithoutItsOriginOrAReason) {
  expect_none(typed_numbers(read_repository(TELEKERF_SOURCE_DIR), shipped_list()));
}

TEST(TypedNumbers, OneIsFoundWithItsUnitAndPlace) {
  for (const char* prose : {"It is 0.7 um off.", "It takes 12 ms.", "(7.3, 177 and 2,600 um)", "by 3 %",
                            "5 to 7 mm", "about 1.7 times", "(0.5\nmm)", "| cell | 3 um |", "11.4 x"}) {
    const Breaches breaches = said_of(prose);
    ASSERT_EQ(breaches.size(), 1u) << prose;
    EXPECT_TRUE(breaches[0].starts_with("docs/results/page.md:3: ")) << breaches[0];
  }
  EXPECT_NE(said_of("It is 7.3, 177 and 2,600 um off.")[0].find("\"7.3, 177 and 2,600 um\""),
            std::string::npos);
}

TEST(TypedNumbers, WhatIsNoMeasureOfAnythingIsLeftAlone) {
  for (const char* prose : {"`--rtt 5 ms`", "```\nsays 5 ms\n```", "figure 8.1", "eq. 94 is a window",
                            "N = 16, R = 1", "chapter 8 says"})
    EXPECT_TRUE(said_of(prose).empty()) << prose;
}

TEST(TypedNumbers, OneThatNamesItsOriginIsHeldAgainstIt) {
  for (const char* prose : {"It is 0.678<!-- claim fast --> um off.", "It is 0.68<!-- claim fast --> um off.",
                            "0.7<!-- claim fast --> um", "It is 1.25<!-- cell t: a; b; 0 --> um off.",
                            "7<!-- cell t: a; 0 --> um", "33<!-- cell page.md#t: a; b; 5 ms --> um",
                            "1.3<!-- cell t: a; b; 0 --> and 33<!-- cell t: a;\nb; 5 ms --> um"})
    EXPECT_TRUE(said_of(prose).empty()) << prose << said_of(prose).front();
  for (const char* prose :
       {"It is 0.67<!-- claim fast --> um off.", "It is 0.679<!-- claim fast --> um off.",
        "100<!-- claim fast --> um", "1<!-- claim slow --> um", "1.25<!-- cell t: a; b; 5 ms --> um",
        "1.25<!-- cell t: a; c; 0 --> um", "1.25<!-- cell s: a; b; 0 --> um",
        "1.25<!-- cell t: a; b; 1 --> um", "1.25<!-- cell gone.md#t: a; b; 0 --> um",
        "1.25<!-- cell t: a; b; 0 --> and 34 um"})
    EXPECT_EQ(said_of(prose).size(), 1u) << prose;
}

TEST(TypedNumbers, AReasonHasToBeTrue) {
  const std::string prose =
      "Runs of 8 s, with `telekerf-experiment`.\n\n### Conditions\n\nA hand of\n20 mm/s.";
  const std::string rest = "docs/results/page.md | setting | ### Conditions\n";
  EXPECT_EQ(said_of(prose).size(), 2u);
  EXPECT_EQ(said_of(prose, rest).size(), 1u);
  for (const char* kind : {"setting", "arithmetic", "clock", "long", "test HoldsIt"})
    EXPECT_TRUE(said_of(prose, rest + "docs/results/page.md | " + kind + " | Runs of 8 s\n").empty()) << kind;
  EXPECT_TRUE(said_of(prose, rest + "docs/results/page.md | setting | hand of 20 mm/s\n").size() == 1u);
  for (const char* row :
       {"docs/results/page.md | test LostIt | Runs of 8 s", "docs/results/page.md | guess | Runs of 8 s",
        "docs/results/page.md | clock | hand of 20 mm/s", "docs/results/page.md | setting | Runs of 9 s",
        "docs/results/gone.md | setting | Runs of 8 s", "docs/results/page.md"})
    EXPECT_GE(said_of(prose, std::string(row) + "\n# all the rest\n" + rest +
                                 "docs/results/page.md | setting | Runs of 8 s\n")
                  .size(),
              1u)
        << row;
}

}  // namespace
}  // namespace telekerf::structure
