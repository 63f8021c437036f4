// SPDX-License-Identifier: Apache-2.0
// What docs/safety.md and docs/field.md promise: fifty hazards, and faults of the field, and each names a
// test or a fault that is there, or what is open.
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>

#include "tests/structure/breaches.h"
#include "tests/structure/repository.h"

namespace telekerf::structure {
namespace {

constexpr const char* kPage = "docs/safety.md";
constexpr const char* kFaults = "experiments/chaos/fault.h";
constexpr int kHazards = 50;
constexpr const char* kField = "docs/field.md";
constexpr int kFieldFaults = 50;  ///< at least

/// "Suite.Test" of every test that the sources define.
std::set<std::string> tests_of(const Repository& repository) {
  static const std::regex kTest(R"(\b(?:TEST|TEST_F|TEST_P|TYPED_TEST|TYPED_TEST_P)\(\s*(\w+),\s*(\w+)\))");
  std::set<std::string> tests;
  for (const auto& [path, text] : repository.files) {
    if (!path.starts_with("tests/") || !is_source(path)) continue;
    for (std::sregex_iterator at(text.begin(), text.end(), kTest), end; at != end; ++at)
      tests.insert((*at)[1].str() + "." + (*at)[2].str());
  }
  return tests;
}

/// The words by which a trial names its faults.
std::set<std::string> faults_of(const Repository& repository) {
  static const std::regex kFault(R"re(\{"([\w-]+)",\s*FaultKind::)re");
  std::set<std::string> faults;
  if (!repository.holds(kFaults)) return faults;
  const std::string& text = repository.files.at(kFaults);
  for (std::sregex_iterator at(text.begin(), text.end(), kFault), end; at != end; ++at)
    faults.insert((*at)[1].str());
  return faults;
}

/// What stands between the bars.
std::vector<std::string> cells_of(const std::string& row) {
  std::vector<std::string> cells;
  std::istringstream in(row.substr(1));
  for (std::string cell; std::getline(in, cell, '|');) cells.push_back(cell);
  return cells;
}

/// Of one row's last cell: what it names that is not there, and whether it says anything at all.
std::vector<std::string> doubts_of(const std::string& proof, const std::set<std::string>& tests,
                                   const std::set<std::string>& faults) {
  static const std::regex kTest(R"(`(\w+\.\w+)`)");
  static const std::regex kTrial(R"(`telekerf-experiment chaos --faults ([\w,-]+)`)");
  static const std::regex kOpen(R"((^|; |\s)open: \S)");
  std::vector<std::string> doubts;
  bool shown = false;
  for (std::sregex_iterator at(proof.begin(), proof.end(), kTest), end; at != end; ++at) {
    shown = true;
    const std::string test = (*at)[1];
    if (!tests.contains(test)) doubts.push_back("names the test " + test + ", which is not there");
  }
  for (std::sregex_iterator at(proof.begin(), proof.end(), kTrial), end; at != end; ++at) {
    shown = true;
    std::istringstream words((*at)[1].str());
    for (std::string word; std::getline(words, word, ',');)
      if (!faults.contains(word)) doubts.push_back("names the fault " + word + ", which is not there");
  }
  if (!shown && !std::regex_search(proof, kOpen))
    doubts.emplace_back("names neither a test nor what is open");
  return doubts;
}

std::vector<std::string> unfounded_hazards(const Repository& repository, int hazards) {
  static const std::regex kRow(R"(^\| (\d+) \| .*\|$)");
  const std::set<std::string> tests = tests_of(repository), faults = faults_of(repository);
  std::vector<std::string> breaches;
  int next = 1;
  for (const std::string& line : lines_of(repository.files.at(kPage))) {
    std::smatch found;
    if (!std::regex_match(line, found, kRow)) continue;
    const std::string row = std::string(kPage) + ", hazard " + found[1].str() + ": ";
    if (found[1].str() != std::to_string(next))
      breaches.push_back(row + "it is the turn of " + std::to_string(next));
    ++next;
    const std::vector<std::string> cells = cells_of(line);
    if (cells.size() != 4) {
      breaches.push_back(row + "a row has four cells");
      continue;
    }
    for (const std::string& doubt : doubts_of(cells[3], tests, faults)) breaches.push_back(row + doubt);
  }
  if (next != hazards + 1)
    breaches.push_back(std::string(kPage) + " has " + std::to_string(next - 1) + " hazards, not " +
                       std::to_string(hazards));
  return breaches;
}

/// Rows of three cells, the last one the proof; `fewest` of them.
std::vector<std::string> unfounded_field_faults(const Repository& repository, int fewest) {
  const std::set<std::string> tests = tests_of(repository), faults = faults_of(repository);
  std::vector<std::string> breaches;
  int rows = 0;
  for (const std::string& line : lines_of(repository.files.at(kField))) {
    if (!line.starts_with("| ") || line.starts_with("| --- ") || line.starts_with("| what was done "))
      continue;
    ++rows;
    const std::vector<std::string> cells = cells_of(line);
    const std::string row = std::string(kField) + ", " + cells.front() + ": ";
    if (cells.size() != 3) {
      breaches.push_back(row + "a row has three cells");
      continue;
    }
    for (const std::string& doubt : doubts_of(cells[2], tests, faults)) breaches.push_back(row + doubt);
  }
  if (rows < fewest)
    breaches.push_back(std::string(kField) + " has " + std::to_string(rows) + " faults, fewer than " +
                       std::to_string(fewest));
  return breaches;
}

TEST(Hazards, EachFaultOfTheFieldNamesATestThatIsThereOrThatItIsOpen) {
  const Repository repository = read_repository(TELEKERF_SOURCE_DIR);
  ASSERT_TRUE(repository.holds(kField));
  expect_none(unfounded_field_faults(repository, kFieldFaults));
}

TEST(Hazards, AFaultOfTheFieldWithoutProofIsFound) {
  Repository repository;
  repository.files["tests/a.cpp"] = "TEST(Field, Holds) {}";
  repository.files[kField] =
      "| what was done | what has to come | test |\n| --- | --- | --- |\n"
      "| a | b | `Field.Holds` |\n"
      "| c | d | open: all of it |\n"
      "| e | f | `Field.Breaks` |\n"
      "| g | h | we believe so |\n"
      "| i | `Field.Holds` |\n";
  const auto breaches = unfounded_field_faults(repository, 6);
  ASSERT_EQ(breaches.size(), 4u);
  EXPECT_NE(breaches[0].find("names the test Field.Breaks, which is not there"), std::string::npos);
  EXPECT_NE(breaches[1].find("names neither a test nor what is open"), std::string::npos);
  EXPECT_NE(breaches[2].find("a row has three cells"), std::string::npos);
  EXPECT_NE(breaches[3].find("has 5 faults, fewer than 6"), std::string::npos);
}

TEST(Hazards, EachNamesATestOrAFaultThatIsThereOrThatItIsOpen) {
  const Repository repository = read_repository(TELEKERF_SOURCE_DIR);
  ASSERT_TRUE(repository.holds(kPage));
  EXPECT_GT(tests_of(repository).size(), 1000u);
  EXPECT_GT(faults_of(repository).size(), 20u);
  expect_none(unfounded_hazards(repository, kHazards));
}

TEST(Hazards, OneWithoutProofIsFound) {
  Repository repository;
  repository.files["tests/a.cpp"] = "TEST(Beam, IsOff) {}\nTYPED_TEST(\n    Stop, Holds) {}";
  repository.files[kFaults] = "{\"loss\", FaultKind::kLoss, \"gone\"}, {\"a-b\",\n FaultKind::kB, \"\"}";
  repository.files[kPage] =
      "| 1 | x | y | `Beam.IsOff`, `Stop.Holds`; open: more |\n"
      "| 2 | x | y | open: all of it |\n"
      "| 3 | x | y | `telekerf-experiment chaos --faults loss,a-b` |\n"
      "| 4 | x | y | `Beam.IsOn` |\n"
      "| 5 | x | y | `telekerf-experiment chaos --faults loss,rain` |\n"
      "| 6 | x | y | we believe so |\n"
      "| 8 | x | `Beam.IsOff` |\n";
  const std::string page = kPage;
  EXPECT_EQ(
      unfounded_hazards(repository, 8),
      (std::vector<std::string>{page + ", hazard 4: names the test Beam.IsOn, which is not there",
                                page + ", hazard 5: names the fault rain, which is not there",
                                page + ", hazard 6: names neither a test nor what is open",
                                page + ", hazard 8: it is the turn of 7",
                                page + ", hazard 8: a row has four cells", page + " has 7 hazards, not 8"}));
}

}  // namespace
}  // namespace telekerf::structure
