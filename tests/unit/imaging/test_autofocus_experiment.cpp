// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment autofocus in its quick form, and the page that its long one has written.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "experiments/autofocus/focus_figures.h"
#include "experiments/autofocus/focus_story.h"
#include "experiments/autofocus/focus_surface.h"

namespace telekerf::experiments {
namespace {

TEST(AutofocusExperiment, MeetsItsBarsOnAFewStarts) {
  const FocusPlan plan{.starts = 3, .seed = 9001};
  const FocusFigures figures = focus_figures(plan);
  for (const Acceptance& bar : acceptance(figures)) EXPECT_TRUE(bar.met()) << bar.name << " " << bar.value;
  const auto json = json_of(figures, plan);
  EXPECT_EQ(json["law"], "search");
  EXPECT_EQ(json["starts"], 9);
  EXPECT_EQ(json["success_rate"], 1.0);
  EXPECT_EQ(json["false_locks"], 0);
  EXPECT_EQ(json["images_used"], 24);
  EXPECT_EQ(json["images_after_zoom"], 7);
  EXPECT_LT(json["focus_error_dof"], 0.1);
  EXPECT_NEAR(json["depth_of_field_um"].get<double>(), 536.2, 0.1);
  EXPECT_TRUE(json["thesis_law"]["success_rate"].is_number());
  EXPECT_EQ(json["rows"].size(), 5U);
  EXPECT_EQ(json["no_focus"]["moving"]["refused"], 9);
  for (const RefusedRow& row : figures.refused) {
    std::size_t reasons = 0;
    for (const auto& [verdict, count] : row.reasons) reasons += count;
    EXPECT_EQ(reasons, row.refused) << row.name;
  }
  EXPECT_EQ(json["no_focus"]["moving"]["reasons"]["moving"], 9);
  // A minute on each of three targets, twenty pictures a second.
  ASSERT_EQ(figures.holds.size(), 3U);
  for (const HoldRow& row : figures.holds) {
    EXPECT_EQ(row.lost, 0U) << row.target;
    EXPECT_EQ(row.all_dof.count, 1201U) << row.target;
    EXPECT_LT(row.passed_dof.rms(), 0.05) << row.target;
    EXPECT_LT(row.passed_dof.max, 0.15) << row.target;
    EXPECT_GT(row.passed_dof.count, 800U) << row.target;
    EXPECT_LT(row.all_dof.rms(), 0.25) << row.target;
  }
}

TEST(AutofocusExperiment, IsTheSameForTheSameSeed) {
  const FocusPlan plan{.starts = 1, .seed = 77};
  EXPECT_EQ(json_of(focus_figures(plan), plan), json_of(focus_figures(plan), plan));
}

TEST(AutofocusExperiment, TheThesisLawAloneHasNoBars) {
  const FocusPlan plan{.starts = 4, .seed = 1, .thesis_only = true};
  const FocusFigures figures = focus_figures(plan);
  ASSERT_EQ(figures.rows.size(), 1U);
  EXPECT_EQ(figures.rows[0].name, "thesis_law");
  // Sixty pictures, and where it ends it says that this is the focus.
  EXPECT_EQ(figures.rows[0].pictures_p50, 60);
  EXPECT_EQ(figures.rows[0].successes + figures.rows[0].false_locks, figures.rows[0].starts);
  EXPECT_EQ(json_of(figures, plan)["law"], "thesis");
}

TEST(AutofocusExperiment, BothExperimentsOfTheThesisEndInFocus) {
  for (const FocusStory story : {FocusStory::kZoomIn, FocusStory::kZoomOut}) {
    const StoryRun run = run_story(story, imaging::FocusLaw::kSearch, 1);
    int passed_on = 0;
    for (std::size_t i = run.frames.size() - 80; i < run.frames.size(); ++i) {  // the last four seconds
      if (!run.frames[i].passed_on) continue;
      ++passed_on;
      EXPECT_LT(std::abs(run.frames[i].defocus_dof), 0.12) << run.frames[i].time_s;
    }
    EXPECT_GT(passed_on, 15);
  }
  const StoryRun printed = run_story(FocusStory::kZoomOut, imaging::FocusLaw::kThesis, 1);
  EXPECT_LT(std::abs(printed.frames.back().defocus_dof), 1.0);
}

TEST(AutofocusExperiment, TheSurfaceHasOneRidge) {
  const SharpnessSurface surface = sharpness_surface(1, 5, 31);
  ASSERT_EQ(surface.sharpness.size(), 5U);
  double before_m = 0.0;
  for (std::size_t i = 0; i < 5; ++i) {
    const auto& row = surface.sharpness[i];
    const auto top = static_cast<std::size_t>(std::max_element(row.begin(), row.end()) - row.begin());
    EXPECT_GE(surface.focus_m[top], before_m);  // a higher magnification, a higher focus
    before_m = surface.focus_m[top];
    EXPECT_GT(row[top], 3.0 * row.front());
  }
}

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(AutofocusExperiment, EachMotorAloneAndTheWholeRasterAreLeftAsNumbers) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "focus-surface";
  std::filesystem::create_directories(folder);
  draw_surface(1, folder);
  for (const char* number : {"7.10", "7.11"}) {
    const auto lines = lines_of(folder / ("figure-" + std::string(number) + ".csv"));
    ASSERT_EQ(lines.size(), 142U) << number << ": a head and 141 places";
    EXPECT_GT(std::filesystem::file_size(folder / ("figure-" + std::string(number) + ".png")), 20000U);
  }
  EXPECT_NE(lines_of(folder / "figure-7.10.csv")[1].find("magnification axis [mm]"), std::string::npos);
  EXPECT_NE(lines_of(folder / "figure-7.11.csv")[1].find("focus axis [mm]"), std::string::npos);
  EXPECT_EQ(lines_of(folder / "figure-7.12.csv").size(), 1U + 41U * 61U);
}

TEST(AutofocusPage, SaysThatTheBarsAreMet) {
  const auto strategies = reporting::read_table(TELEKERF_AUTOFOCUS_PAGE, "strategies");
  ASSERT_EQ(strategies.size(), 6U);
  EXPECT_EQ(strategies[1][0], "search");
  EXPECT_GE(std::stod(strategies[1][1]), 99.5);
  EXPECT_EQ(strategies[1][2], "0 of 600");
  EXPECT_LE(std::stoi(strategies[1][3]), 26);
  EXPECT_LE(std::stod(strategies[1][5]), 0.1);
  const auto refused = reporting::read_table(TELEKERF_AUTOFOCUS_PAGE, "refused");
  ASSERT_EQ(refused.size(), 4U);
  for (std::size_t i = 1; i < refused.size(); ++i) EXPECT_EQ(refused[i][1], "600 of 600") << refused[i][0];
  const auto zoom = reporting::read_table(TELEKERF_AUTOFOCUS_PAGE, "zoom");
  EXPECT_EQ(zoom[1][0], zoom[1][1]);
  EXPECT_LE(std::stoi(zoom[1][2]), 8);
  EXPECT_LE(std::stod(zoom[1][5]), 0.2);
}

}  // namespace
}  // namespace telekerf::experiments
