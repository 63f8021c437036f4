// SPDX-License-Identifier: Apache-2.0
// docs/results/delay.md: its cells are measured again, with the tuning that stands in it.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "experiments/delay/delay_tables.h"

namespace telekerf::experiments {
namespace {

using reporting::TableRows;

TableRows page_table(const std::string& name) { return reporting::read_table(TELEKERF_DELAY_PAGE, name); }

/// The page's cell is what is measured now, to its last digit; a build for a sanitizer rounds otherwise.
void expect_cell(const std::string& page, const std::string& now, const std::string& where) {
  if (page == "unstable" || now == "unstable") {
    EXPECT_EQ(page, now) << where;
    return;
  }
  const double value = std::stod(page);
  EXPECT_NEAR(std::stod(now), value, std::max(0.011, 0.02 * value)) << where;
}

TEST(DelayPage, HoldsOverRoundTripsForTheRivalsThatMatterAndAt100MillisecondsForAll) {
  const TableRows tracking = page_table("tracking");
  const TableRows prediction = page_table("prediction");
  const TableRows tuning = page_table("tuning");
  ASSERT_EQ(tracking.size(), rivals().size() + 1);
  ASSERT_EQ(prediction.size(), tracking.size());
  ASSERT_EQ(tuning.size(), tracking.size());
  const HandRecord hand = record_hand("heart", Length{}.grid_s, 1);
  for (std::size_t r = 0; r < rivals().size(); ++r) {
    const Rival& rival = rivals()[r];
    ASSERT_EQ(tracking[r + 1][0], law_of(rival));
    ASSERT_EQ(tracking[r + 1][1], word_of(rival.estimator));
    for (std::size_t c = 0; c < table_conditions().size(); ++c) {
      const Condition& at = table_conditions()[c];
      if (r > 3 && at.rtt_ms != 100.0) continue;
      DelayTrial trial =
          trial_of(rival, netem::simple_profile(at.rtt_ms * 1e-3, at.jitter_ms * 1e-3, at.loss), 1);
      const std::string& tuned = tuning[r + 1][c + 2];
      ASSERT_EQ(tuned == "as shipped", tuning_of(trial).empty()) << law_of(rival);
      trial = with_tuning(trial, parsed_tuning(trial, tuned));
      const DelayResult result = run_trial(hand, trial);
      const std::string where =
          fmt::format("{} + {}, {} ms", law_of(rival), word_of(rival.estimator), at.rtt_ms);
      expect_cell(tracking[r + 1][c + 2], cell(result, &DelayResult::tracking_rmse_um), where);
      expect_cell(prediction[r + 1][c + 2], cell(result, &DelayResult::prediction_rmse_um), where);
    }
  }
}

TEST(DelayPage, HoldsOnShippedProfilesForTheDefault) {
  const TableRows page = page_table("profiles");
  const Length length;
  std::map<std::string, std::vector<double>> measured;
  for (int seed = 1; seed <= length.profile_seeds; ++seed) {
    const HandRecord hand = record_hand("heart", length.profile_s, static_cast<std::uint64_t>(seed));
    for (const char* profile : {"thesis-constant", "wifi", "leo"}) {
      const DelayTrial trial =
          trial_of(rivals().front(), netem::load_profile(profile), static_cast<std::uint64_t>(seed));
      measured[profile].push_back(run_trial(hand, trial).tracking_rmse_um);
    }
  }
  for (auto& [profile, values] : measured) {
    const auto row =
        std::find_if(page.begin(), page.end(), [&](const auto& cells) { return cells[0] == profile; });
    ASSERT_NE(row, page.end()) << profile;
    std::sort(values.begin(), values.end());
    const std::string& text = (*row)[1];
    const std::size_t slash = text.find(" / ");
    ASSERT_NE(slash, text.npos) << text;
    expect_cell(text.substr(0, slash), fmt::format("{}", values[values.size() / 2]), profile + ", median");
    expect_cell(text.substr(slash + 3), fmt::format("{}", values.back()), profile + ", worst");
  }
}

}  // namespace
}  // namespace telekerf::experiments
