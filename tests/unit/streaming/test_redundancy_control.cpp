// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <initializer_list>
#include <vector>

#include "common/streaming/redundancy_control.h"

namespace telekerf::streaming {
namespace {

constexpr int kBlock = 16;
constexpr double kBlock_s = 16e-3;

class GapFinderTest : public testing::Test {
 protected:
  /// `steps` of the slave at which it applied each command, or none of those that were due.
  void slave(int steps, bool applied) {
    std::vector<SlaveSample> samples;
    for (int n = 0; n < steps; ++n) {
      samples.push_back({.index = index_++, .time = time_++, .applied = applied});
    }
    finder_.received(samples, engaged_from_);
  }
  Gap take() { return finder_.take(); }

  GapFinder finder_;
  std::int64_t engaged_from_ = 100;
  std::int64_t index_ = 100;
  std::int64_t time_ = 5000;
};

TEST_F(GapFinderTest, FindsTheLongestGapBetweenTwoCommandsThatWereApplied) {
  slave(20, true);
  EXPECT_EQ(take().samples, 0);
  slave(40, false);
  EXPECT_EQ(take().samples, 0) << "it has not ended yet";
  slave(1, true);
  slave(10, false);
  slave(1, true);
  const Gap gap = take();
  EXPECT_EQ(gap.samples, 40);
  EXPECT_EQ(gap.before, 119);
  EXPECT_EQ(gap.after, 160);
  EXPECT_EQ(take().samples, 0) << "told once";
}

TEST_F(GapFinderTest, WhatWasNotAppliedBeforeTheEngagementIsNoGap) {
  slave(300, false);
  slave(20, true);
  EXPECT_EQ(take().samples, 0);
  engaged_from_ = index_ + 500;  // let go, and taken hold of again
  slave(500, false);
  slave(20, true);
  EXPECT_EQ(take().samples, 0);
  slave(30, false);
  slave(20, true);
  EXPECT_EQ(take().samples, 30);
}

TEST_F(GapFinderTest, ASlaveThatStoodAndWentOnWhereItHadBeenHasLostNothing) {
  slave(20, true);
  slave(300, false);
  index_ -= 300;  // what came late was applied, all of it
  slave(20, true);
  EXPECT_EQ(take().samples, 0);
  slave(300, false);
  index_ -= 290;
  slave(1, true);
  EXPECT_EQ(take().samples, 10) << "what was left out";
}

TEST_F(GapFinderTest, StatesThatDidNotArriveSayNothing) {
  slave(20, true);
  slave(10, false);
  time_ += 64;
  index_ += 64;
  slave(10, false);
  slave(1, true);
  EXPECT_EQ(take().samples, 10);
}

TEST_F(GapFinderTest, OverAConcealedStretchTheLastAcknowledgementStandsAndItIsAGapAllTheSame) {
  slave(20, true);
  std::vector<SlaveSample> samples;
  for (int n = 0; n < 48; ++n) samples.push_back({.index = index_ - 1, .time = time_++, .applied = true});
  finder_.received(samples, engaged_from_);
  index_ += 48;
  slave(1, true);
  EXPECT_EQ(take().samples, 48);
}

class BurstFinderTest : public testing::Test {
 protected:
  void come(std::initializer_list<std::uint32_t> numbers) {
    for (const std::uint32_t number : numbers) finder_.received(number, false);
  }
  void come(std::uint32_t from, std::uint32_t to) {
    for (std::uint32_t number = from; number != to; ++number) finder_.received(number, false);
  }
  BurstFinder finder_;
};

TEST_F(BurstFinderTest, TellsTheLongestRunOfNumbersThatHaveNotComeWithin32) {
  come(100, 120);  // 3 missing
  come(123, 130);  // 1 missing
  come(131, 154);
  EXPECT_EQ(finder_.take(), 0) << "119 may still be late";
  come(154, 156);
  EXPECT_EQ(finder_.take(), 3);
  come(156, 164);
  EXPECT_EQ(finder_.take(), 1);
  come(164, 200);
  EXPECT_EQ(finder_.take(), 0);
}

TEST_F(BurstFinderTest, WhatComesAfter31OthersCameAndAfter32ItIsLost) {
  for (const std::uint32_t others : {31U, 32U}) {
    finder_ = {};
    come(0, 50);
    come(51, 51 + others);
    come({50});
    come(51 + others, 120);
    EXPECT_EQ(finder_.take(), others == 31 ? 0 : 1) << others;
  }
}

TEST_F(BurstFinderTest, OrderAndRepetitionAreNoLossAndNumbersWrapAround) {
  come(0xFFFFFFF0U, 0xFFFFFFFEU);
  come({2, 0xFFFFFFFFU, 0xFFFFFFFEU, 0, 1, 1, 2, 0xFFFFFFF3U});
  come(3, 100);
  EXPECT_EQ(finder_.take(), 0);
  come({102, 103, 101, 104});
  come(105, 200);
  EXPECT_EQ(finder_.take(), 1) << "100";
}

TEST_F(BurstFinderTest, ABlackoutIsABurstAndAnotherSenderIsNot) {
  come(1, 10);
  come(1000, 1040);
  EXPECT_GE(finder_.take(), 31);
  finder_.received(5, true);
  come(6, 100);
  EXPECT_EQ(finder_.take(), 0);
}

class RedundancyControlTest : public testing::Test {
 protected:
  /// A gap of so many samples that ended where a block began, `blocks_ago` blocks before this one.
  int step(int gap_samples = 0, int states = 0, int blocks_ago = 1) {
    index_ += kBlock;
    const std::int64_t after = index_ - std::int64_t{blocks_ago} * kBlock;
    return control_.step({{after - gap_samples - 1, after, gap_samples}, states}, {index_, kBlock, kBlock_s});
  }
  /// Seconds without a loss.
  int quiet(double seconds) {
    int copies = 0;
    for (int n = 0; n < static_cast<int>(seconds / kBlock_s); ++n) copies = step();
    return copies;
  }

  RedundancyControl control_{RedundancySettings{}};
  std::int64_t index_ = 16'000;
};

TEST_F(RedundancyControlTest, WithoutALossThereAreAsFewCopiesAsAllowed) {
  for (const int min : {0, 1, 3, 7}) {
    control_ = RedundancyControl({.min = min});
    EXPECT_EQ(quiet(100.0), min);
  }
}

TEST_F(RedundancyControlTest, AGapThatEndsWithinABlockIsJitterAndNoLoss) {
  for (int samples = 1; samples < 80; ++samples) {
    const std::int64_t after = index_ - 7;
    EXPECT_EQ(control_.step({{after - samples - 1, after, samples}, 0}, {index_, kBlock, kBlock_s}), 1);
  }
  EXPECT_EQ(step(kBlock - 1), 1) << "and what is shorter than a block";
  EXPECT_EQ(step(kBlock), 4) << "two in a row, of which one had a copy: covers four";
}

TEST_F(RedundancyControlTest, ItCoversTwiceTheBurstThatLeftTheGap) {
  EXPECT_EQ(step(2 * kBlock + 7), 6);
  quiet(1.0);
  EXPECT_EQ(step(kBlock), 7) << "no more than there is room for";
  for (const int max : {1, 2, 5}) {
    control_ = RedundancyControl({.min = 1, .max = max});
    EXPECT_EQ(step(10 * kBlock), max);
  }
}

TEST_F(RedundancyControlTest, BurstsOfStatesCountAlike) {
  EXPECT_EQ(step(0, 1), 2);
  EXPECT_EQ(step(0, 2), 4);
  EXPECT_EQ(step(0, 1), 4);
  EXPECT_EQ(step(0, 30), 7);
}

TEST_F(RedundancyControlTest, AGapFromBeforeItHadMoreCopiesIsJudgedByThoseOfThatTime) {
  EXPECT_EQ(step(kBlock), 4);
  EXPECT_EQ(step(kBlock, 0, 3), 4) << "also two in a row";
  quiet(1.0);
  EXPECT_EQ(step(kBlock), 7) << "five in a row";
}

TEST_F(RedundancyControlTest, ACopyIsGivenUpAfterEveryThirtySecondsWithoutABurstThatAsksForIt) {
  EXPECT_EQ(step(100), 7);
  EXPECT_EQ(quiet(29.9), 7);
  EXPECT_EQ(step(0, 4), 7) << "the time begins anew";
  EXPECT_EQ(quiet(29.9), 7);
  EXPECT_EQ(step(0, 1), 7) << "not for a burst that fewer cover";
  EXPECT_EQ(quiet(1.0), 6);
  EXPECT_EQ(quiet(200.0), 1) << "down to the least";
}

}  // namespace
}  // namespace telekerf::streaming
