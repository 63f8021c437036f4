// SPDX-License-Identifier: Apache-2.0
// docs/results/delay.md: its cells are measured again, with the tuning that stands in it.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "experiments/delay/delay_tables.h"
#include "tests/unit/page_cells.h"

namespace telekerf::experiments {
namespace {

using reporting::TableRows;

TableRows page_table(const std::string& name) { return reporting::read_table(TELEKERF_DELAY_PAGE, name); }

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
    expect_cell((*row)[1], fmt::format("{} / {}", values[values.size() / 2], values.back()), profile);
  }
}

}  // namespace
}  // namespace telekerf::experiments
