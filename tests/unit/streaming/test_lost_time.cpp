// SPDX-License-Identifier: Apache-2.0
// What a sender's loop has lost, by its stamps, and how old the copies of its blocks may therefore be.
#include "common/streaming/lost_time.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/streaming/command_receiver_fixture.h"

namespace telekerf::streaming {
namespace {

constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();

/// Blocks of 16 samples of 1 ms, whose sender's clock is `lag` ahead of the samples' time.
void arrive(LostTime& lost, int block, std::int64_t lag_ns) {
  const std::int64_t last = 16 * block + 15;
  lost.arrived(1, last * kMs, last * kMs + lag_ns);
}

TEST(LostTime, CountsFromTheNewestBlockThatWasSentBefore) {
  LostTime lost;
  EXPECT_FALSE(lost.since_ns(0 * kMs)) << "nothing came";
  arrive(lost, 1, 5 * kMs);
  arrive(lost, 2, 5 * kMs);
  arrive(lost, 5, 17 * kMs);
  EXPECT_FALSE(lost.since_ns(31 * kMs)) << "nothing came before it";
  EXPECT_EQ(lost.since_ns(32 * kMs), 12 * kMs);
  EXPECT_EQ(lost.since_ns(48 * kMs), 12 * kMs) << "somewhere after the second";
  EXPECT_EQ(lost.since_ns(95 * kMs), 12 * kMs) << "the newest block itself";
  EXPECT_EQ(lost.since_ns(96 * kMs), 0) << "nothing since";
  arrive(lost, 6, 20 * kMs);
  EXPECT_EQ(lost.since_ns(96 * kMs), 3 * kMs);
  EXPECT_EQ(lost.since_ns(48 * kMs), 15 * kMs);
  lost.arrived(2, 127 * kMs, 200 * kMs);
  EXPECT_FALSE(lost.since_ns(96 * kMs)) << "another sender";
}

TEST(LostTime, OfALateBlockCountsToWhenItWasSentItself) {
  LostTime lost;
  arrive(lost, 1, 5 * kMs);
  arrive(lost, 5, 17 * kMs);
  arrive(lost, 3, 9 * kMs);
  EXPECT_EQ(lost.since_ns(32 * kMs), 4 * kMs);
}

TEST(LostTime, IsNeverWon) {
  LostTime lost;
  arrive(lost, 1, 5 * kMs);
  arrive(lost, 2, 4 * kMs);
  EXPECT_EQ(lost.since_ns(32 * kMs), 0);
}

TEST(LostTime, OfAStampThatNoClockSaysIsNotKnown) {
  for (const std::int64_t wrong : {std::int64_t{-1}, std::int64_t{1} << 62, kLargest, -kLargest}) {
    LostTime lost;
    arrive(lost, 1, 5 * kMs);
    lost.arrived(1, 47 * kMs, wrong);
    EXPECT_FALSE(lost.since_ns(32 * kMs)) << wrong;
    arrive(lost, 3, 6 * kMs);
    EXPECT_EQ(lost.since_ns(32 * kMs), kMs) << "that of the next is";
  }
}

TEST(LostTime, RemembersSixteenBlocks) {
  LostTime lost;
  for (int block = 0; block < 17; ++block) arrive(lost, block, 5 * kMs);
  EXPECT_FALSE(lost.since_ns(16 * kMs)) << "forgotten";
  EXPECT_EQ(lost.since_ns(32 * kMs), 0);
}

class AgeOfCopies : public CommandReceiverTest {
 protected:
  /// The master hears of state block 1, sent at 4 ms, for good: what it says is as old as that.
  AgeOfCopies() {
    receiver_.state_sent(1, kEcho_ns);
    change_ = [](CommandBlock& block) {
      block.echo_sequence = 1;
      block.echo_sent_ns = kEcho_ns;
    };
  }
  static constexpr std::int64_t kEcho_ns = 4 * kMs;

  /// Oldest and youngest age of what is played of block `sequence`, s; where time is lost, that it is.
  void watch(std::uint32_t sequence) {
    oldest_s_ = 0.0;
    run(8, [&](const Played& played) {
      if (played.sample != nullptr && played.sample->block == sequence) {
        ++steps_;
        if (!played.age_s)
          ++unknown_;
        else
          oldest_s_ = std::max(oldest_s_, *played.age_s - 1e-9 * static_cast<double>(now_ns_ - kEcho_ns));
      }
    });
  }
  int steps_ = 0, unknown_ = 0;
  double oldest_s_ = 0.0;  ///< than the echo of the newest block says
};

TEST_F(AgeOfCopies, IsABlockMoreThanThatOfThePacket) {
  run(20);
  next();  // lost
  watch(21);
  EXPECT_GE(steps_, 15);
  EXPECT_EQ(unknown_, 0);
  EXPECT_NEAR(oldest_s_, 0.016, 1e-9);
}

TEST_F(AgeOfCopies, AndWhatTheMasterSleptInBetween) {
  run(20);
  next();  // lost
  lost_ns_ = 12 * kMs;
  watch(21);
  EXPECT_GE(steps_, 15);
  EXPECT_NEAR(oldest_s_, 0.016 + 0.012, 1e-9);
}

TEST_F(AgeOfCopies, IsNotKnownOfWhatWasSentBeforeTheFirstThatCame) {
  next();
  watch(1);
  EXPECT_EQ(unknown_, steps_);
}

TEST_F(AgeOfCopies, IsNotKnownWhereTheEchoIsNoTime) {
  for (const std::int64_t wrong : {std::int64_t{-1}, -kLargest - 1, std::int64_t{1} << 62}) {
    change_ = [=](CommandBlock& block) {
      block.echo_sequence = 1;
      block.echo_sent_ns = wrong;
    };
    run(4);
    EXPECT_FALSE(played_.age_s) << wrong;
  }
}

}  // namespace
}  // namespace telekerf::streaming
