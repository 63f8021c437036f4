// SPDX-License-Identifier: Apache-2.0
// What the slave's log says of its steps is what the master reads out of it, over the wire's fields.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "common/streaming/acknowledgement.h"

namespace telekerf::streaming {
namespace {

/// A play-out that goes on by one index a step, and follows what is due or not.
TEST(Acknowledgement, TheMasterReadsWhatTheSlaveDidAtEverySample) {
  std::mt19937 random(11);
  std::geometric_distribution<int> length(0.1);
  AcknowledgementLog log;
  std::vector<bool> followed;
  bool follows = true;
  int left = 0;
  int gaps = 0;
  for (std::int64_t step = 0; step < 5000; ++step) {
    if (left-- == 0) {
      follows = !follows;
      gaps += follows ? 0 : 1;
      left = length(random);
    }
    followed.push_back(follows);
    const Acknowledgement said = log.step(follows ? Applied::kSample : Applied::kNothing, step, step == 0);
    StateHeader header;
    header.ticks_per_sample = 1;
    write(said, 4, header);
    const Acknowledgement heard = read(header, 4);
    EXPECT_EQ(heard.age, said.age);
    if (said.index < 0) continue;
    ASSERT_EQ(heard.index, said.index);
    for (std::int64_t back = 0; back < std::min<std::int64_t>(step, 60); ++back) {
      const AppliedCommand command = applied_at(heard, back);
      if (command.index < 0) break;
      ASSERT_EQ(command.index, step - back);
      if (command.index > said.index - 64) {
        ASSERT_EQ(command.applied, followed[static_cast<std::size_t>(step - back)]) << step << " - " << back;
      }
    }
  }
  EXPECT_GT(gaps, 100);
}

TEST(Acknowledgement, TheSameSampleTwiceIsOneAndALongGapEmptiesTheBitmap) {
  AcknowledgementLog log;
  (void)log.step(Applied::kSample, 5, true);
  Acknowledgement said = log.step(Applied::kSample, 5, false);
  EXPECT_EQ(said.index, 5);
  EXPECT_EQ(said.bitmap, 1u);
  said = log.step(Applied::kSample, 6, false);
  EXPECT_EQ(said.bitmap, 3u);
  said = log.step(Applied::kSample, 7 + 64, false);
  EXPECT_EQ(said.bitmap, 1u);
  (void)log.step(Applied::kSample, 72, false);
  said = log.step(Applied::kSample, 72 + 63, false);
  EXPECT_EQ(said.bitmap, (std::uint64_t{1} << 63) | 1U);
  (void)log.step(Applied::kSample, 136, false);
  said = log.step(Applied::kSample, 136 + 64, false);
  EXPECT_EQ(said.bitmap, 1u);
}

TEST(Acknowledgement, AStreamThatBeginsAnewHasNothingApplied) {
  AcknowledgementLog log;
  (void)log.step(Applied::kSample, 700, true);
  Acknowledgement said = log.step(Applied::kNothing, -1, true);
  EXPECT_LT(said.index, 0);
  EXPECT_EQ(said.bitmap, 0u);
  StateHeader header;
  write(said, 1, header);
  EXPECT_EQ(header.applied_tick, 0u);
  said = log.step(Applied::kSample, 3, false);
  EXPECT_EQ(said.index, 3) << "smaller than before, and newer";
  EXPECT_EQ(said.age, 0);
}

TEST(Acknowledgement, BeforeTheFirstSampleNothingWasApplied) {
  AcknowledgementLog unheard;  // nobody has begun anything yet
  EXPECT_EQ(unheard.step(Applied::kNothing, -1, false).index, -1);
  EXPECT_EQ(unheard.step(Applied::kNothing, -1, false).bitmap, 0u);
  AcknowledgementLog log;
  for (int n = 1; n <= 3; ++n) {
    const Acknowledgement said = log.step(Applied::kNothing, -1, n == 1);
    EXPECT_EQ(said.index, -1);
    EXPECT_EQ(said.age, n) << "steps since the beginning";
    EXPECT_EQ(said.bitmap, 0u);
  }
  EXPECT_EQ(log.step(Applied::kSample, 0, false).bitmap, 1u);
  const AppliedCommand nobodys;
  EXPECT_EQ(nobodys.index, -1);
  EXPECT_FALSE(nobodys.applied);
}

TEST(Acknowledgement, WhatIsOlderThanTheBitmapIsTakenForApplied) {
  const Acknowledgement heard{.index = 100, .age = 2, .bitmap = 0};
  for (const std::int64_t back : {0, 1, 2, 65, 66, 80}) {
    EXPECT_EQ(applied_at(heard, back).index, 102 - back);
    EXPECT_EQ(applied_at(heard, back).applied, back >= 66) << back;
  }
}

TEST(Acknowledgement, TheTwoStreamsMayHaveDifferentRates) {
  StateHeader header;
  header.ticks_per_sample = 2;    // slave's control steps a sample
  header.applied_tick = 300;      // master's ticks, three a sample
  header.applied_age_ticks = 10;  // slave's control steps
  const Acknowledgement heard = read(header, 3);
  EXPECT_EQ(heard.index, 100);
  EXPECT_EQ(heard.age, 5);
}

}  // namespace
}  // namespace telekerf::streaming
