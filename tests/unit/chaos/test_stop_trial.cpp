// SPDX-License-Identifier: Apache-2.0
// The stop is answered within the round trip and two ticks, and within 60 ms of it where a fifth is lost; it
// outlasts restarts.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "experiments/chaos/stop_trial.h"

namespace telekerf::experiments {
namespace {

// `./telekerf check chaos` tries a thousand.
TEST(StopTrial, IsAnsweredInTimeInTwoHundredTrialsWithAndWithoutLosses) {
  nlohmann::ordered_json out;
  EXPECT_TRUE(try_stops(1, 200, out)) << out.dump();
  EXPECT_LE(out["acknowledged_over_rtt_ms_max"].get<double>(), 2.0);
  EXPECT_LE(out["acknowledged_over_rtt_ms_max_at_20_percent_loss"].get<double>(), 60.0);
  EXPECT_GT(out["acknowledged_over_rtt_ms_max_at_20_percent_loss"].get<double>(), 5.0) << "some were lost";
  EXPECT_TRUE(out["survived_restarts"].get<bool>());
}

TEST(StopTrial, ALoopObeysWithinATickOfTheFirstCopy) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const StopOutcome outcome = try_stop({.seed = seed, .rtt_s = 0.1, .loss = 0.0});
    EXPECT_GE(outcome.obeyed_s, 0.05 - 1e-9);
    EXPECT_LE(outcome.obeyed_s, 0.051 + 1e-9);
    EXPECT_GT(outcome.acknowledged_s, outcome.obeyed_s + 0.05 - 1e-3);
    EXPECT_TRUE(outcome.survived);
  }
}

TEST(StopTrial, WhereNothingComesThroughNothingIsClaimed) {
  const StopOutcome outcome = try_stop({.seed = 1, .rtt_s = 0.01, .loss = 1.0});
  EXPECT_LT(outcome.acknowledged_s, 0.0);
  EXPECT_LT(outcome.obeyed_s, 0.0);
  EXPECT_FALSE(outcome.survived);
}

}  // namespace
}  // namespace telekerf::experiments
