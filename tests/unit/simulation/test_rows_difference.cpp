// SPDX-License-Identifier: Apache-2.0
// Which rows of a replay stand for which of the run.
#include <gtest/gtest.h>

#include "experiments/replay/rows_difference.h"

namespace telekerf::experiments {
namespace {

/// A slave that applies the master's ticks from `delay` rows on; its tool is 1 um further each tick of the master.
RunRecord run(std::uint64_t first_tick, std::size_t delay, double off_m = 0.0) {
  RunRecord record;
  for (std::size_t n = 0; n < 100; ++n) {
    record.master.push_back({.tick = first_tick + n, .tool_m = Vec3(1e-6 * static_cast<double>(n), 0.0, 0.0)});
    SlaveRow slave{.tick = n};
    if (n >= delay) {
      slave.applied = static_cast<double>(first_tick + n - delay);
      slave.tool_m.x() = 1e-6 * static_cast<double>(n - delay) + off_m;
    }
    record.slave.push_back(slave);
  }
  return record;
}

TEST(RowsDifference, OfARealRunTheSlavesRowsAreThoseThatApplyTheSameTick) {
  const RunRecord recorded = run(5000, 30), replayed = run(0, 12);
  const auto real = compare(recorded, replayed, false);
  EXPECT_EQ(real[0].different, 0U) << "ticks of the master count from its first";
  EXPECT_EQ(real[1].compared, 70U) << "what holds has no counterpart";
  EXPECT_EQ(real[1].different, 0U);
  EXPECT_NEAR(real[1].tool_max_m, 0.0, 1e-15);
  EXPECT_NEAR(compare(recorded, run(0, 12, 3e-6), false)[1].tool_rms_m, 3e-6, 1e-12);
}

TEST(RowsDifference, BetweenTwoReplayedRowsIsTheirMean) {
  RunRecord recorded = run(0, 10);
  for (SlaveRow& row : recorded.slave) {
    if (row.applied < 0.0) continue;
    row.applied += 0.25;
    row.tool_m.x() += 0.25e-6;
  }
  const auto difference = compare(recorded, run(0, 5), false)[1];
  EXPECT_EQ(difference.compared, 90U);
  EXPECT_LT(difference.tool_max_m, 1e-12);
}

TEST(RowsDifference, WhatTheReplayPassedOverIsNotCompared) {
  RunRecord replayed = run(0, 5);
  replayed.slave.erase(replayed.slave.begin() + 40, replayed.slave.begin() + 60);
  const auto difference = compare(run(0, 5), replayed, false)[1];
  EXPECT_EQ(difference.compared, 75U);
  EXPECT_EQ(difference.recorded, 100U);
  EXPECT_EQ(difference.replayed, 80U);
}

TEST(RowsDifference, OfAVirtualRunRowsAreComparedByNumberBitByBit) {
  const auto same = compare(run(0, 10), run(0, 10), true);
  EXPECT_TRUE(same[0].identical());
  EXPECT_TRUE(same[1].identical());
  RunRecord other = run(0, 10);
  other.slave[50].force_n.y() = -0.0;
  const auto difference = compare(run(0, 10), other, true)[1];
  EXPECT_EQ(difference.different, 1U);
  EXPECT_EQ(difference.first_tick, 50.0);
  EXPECT_EQ(difference.column, "force_y_n");
  EXPECT_FALSE(compare(run(0, 10), run(7, 10), true)[0].identical()) << "ticks count";
}

}  // namespace
}  // namespace telekerf::experiments
