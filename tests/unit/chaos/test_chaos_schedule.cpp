// SPDX-License-Identifier: Apache-2.0
// What a seed draws: the same again, each kind by itself, and nothing after the end.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "experiments/chaos/fault.h"

namespace telekerf::experiments {
namespace {

bool same(const FaultWindow& a, const FaultWindow& b) {
  return a.kind == b.kind && a.from_s == b.from_s && a.strength == b.strength && a.word == b.word;
}

std::vector<FaultKind> all_kinds() {
  std::vector<FaultKind> kinds;
  for (const auto& row : kFaultRows) kinds.push_back(row.value);
  return kinds;
}

TEST(ChaosSchedule, SeedsDrawSubsetsAndTogetherEveryKind) {
  std::set<FaultKind> seen;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto kinds = drawn_kinds(seed);
    EXPECT_EQ(kinds, drawn_kinds(seed));
    EXPECT_FALSE(kinds.empty());
    EXPECT_LT(kinds.size(), std::size(kFaultRows));
    seen.insert(kinds.begin(), kinds.end());
  }
  EXPECT_EQ(seen.size(), std::size(kFaultRows));
}

TEST(ChaosSchedule, LeavingAKindOutOrEndingEarlierChangesNothingElse) {
  const auto whole = draw_schedule(7, all_kinds(), 30.0);
  for (const auto& row : kFaultRows) {
    const auto alone = draw_schedule(7, {row.value}, 15.0);
    EXPECT_EQ(alone.rtt_s, whole.rtt_s);
    for (const FaultWindow& window : alone.windows) {
      EXPECT_LE(window.to_s, 15.0);
      EXPECT_LT(window.from_s, 15.0);
      EXPECT_TRUE(std::any_of(whole.windows.begin(), whole.windows.end(), [&](const FaultWindow& other) {
        return same(window, other);
      })) << row.word;
    }
  }
}

TEST(ChaosSchedule, ASwizzleClogsFourLinesAndReleasesAllOfThem) {
  const auto schedule = draw_schedule(3, {FaultKind::kSwizzle}, 60.0);
  ASSERT_FALSE(schedule.windows.empty());
  EXPECT_EQ(schedule.windows.size() % 4, 0u);
  for (const FaultWindow& window : schedule.windows) EXPECT_NE(window.kind, FaultKind::kSwizzle);
}

TEST(ChaosSchedule, AnOutageLosesEverythingInItsOwnDirectionAndHeals) {
  const auto schedule = draw_schedule(5, {FaultKind::kOutageForward}, 20.0);
  ASSERT_FALSE(schedule.windows.empty());
  const FaultWindow& outage = schedule.windows.front();
  for (const bool forward : {true, false}) {
    const auto profile = link_profile(schedule, forward);
    for (const netem::Stage& stage : profile.stages) {
      const bool down =
          forward && std::any_of(schedule.windows.begin(), schedule.windows.end(),
                                 [&](const auto& window) { return window.holds(stage.from_s); });
      EXPECT_EQ(stage.conditions.loss.loss, down ? 1.0 : 0.0) << stage.from_s;
    }
    EXPECT_EQ(profile.stages.front().from_s, 0.0);
    EXPECT_EQ(profile.stages.back().conditions.loss.loss, 0.0);
  }
  EXPECT_GT(outage.to_s, outage.from_s);
}

}  // namespace
}  // namespace telekerf::experiments
