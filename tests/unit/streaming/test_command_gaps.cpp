// SPDX-License-Identifier: Apache-2.0
// The slave's end of the command stream where blocks are missing or late.
#include <cmath>

#include "tests/unit/streaming/command_receiver_fixture.h"

namespace telekerf::streaming {
namespace {

TEST_F(CommandReceiverTest, AGapWithBothEndsKnownIsConcealed) {
  change_ = [](CommandBlock& block) {
    block.law = Law::kAnchored;
    block.anchor = {place(static_cast<std::int64_t>(block.first_tick)), Vec3(1e-2, 0, 0)};
  };
  for (int b = 0; b < 8; ++b) {
    const CommandBlock block = next();
    if (b < 3 || b > 5) receiver_.receive({block, now_ns_ + b}, 4, now_ns_);
  }
  // Block 6 brings a copy of block 5: two blocks are gone.
  int concealed = 0;
  for (int n = 0; n < 7 * kBlock; ++n, now_ns_ += kMs) {
    played_ = receiver_.play(now_ns_, kTool);
    ASSERT_TRUE(played_.cursor);
    if (*played_.cursor < 0.0) continue;
    ASSERT_NE(played_.sample, nullptr) << *played_.cursor;
    EXPECT_EQ(played_.sample->concealed, played_.index >= 3 * kBlock && played_.index < 5 * kBlock);
    EXPECT_LT((played_.state.position_m - place(played_.index)).norm(), 2e-6) << played_.index;
    concealed += played_.sample->concealed ? 1 : 0;
  }
  EXPECT_EQ(concealed, 2 * kBlock);
}

TEST_F(CommandReceiverTest, AGapOf720SamplesIsConcealedAndNoLongerOne) {
  for (const int more : {0, 1}) {
    receiver_ = CommandReceiver{{}};
    sender_ = Sender<CommandBlock>(7);
    change_ = [&](CommandBlock& block) {
      block.law = Law::kAnchored;
      if (block.sequence > 20) block.first_tick += static_cast<Tick>(more);
      block.anchor = {place(static_cast<std::int64_t>(block.first_tick)), Vec3(1e-2, 0, 0)};
    };
    // Blocks 1 and 2, and 49 with a copy of 48: 45 blocks are missing between.
    for (int b = 1; b <= 49; ++b) {
      const CommandBlock block = next();
      if (b <= 2 || b == 49) receiver_.receive({block, 15 * kMs + b}, 4, 15 * kMs + b);
    }
    int concealed = 0;
    for (int n = 0; n < 50 * kBlock; ++n) {
      played_ = receiver_.play(15 * kMs + 100 + n * kMs / 4, kTool);
      if (played_.sample != nullptr && played_.sample->concealed) ++concealed;
    }
    EXPECT_EQ(concealed > 0, more == 0) << concealed;
  }
}

TEST_F(CommandReceiverTest, PositionsThatAreMissingAreNotConcealed) {
  for (int b = 0; b < 8; ++b) {
    const CommandBlock block = next();
    if (b < 3 || b > 5) receiver_.receive({block, now_ns_ + b}, 4, now_ns_ + b);
  }
  int missing = 0;
  for (int n = 0; n < 7 * kBlock; ++n, now_ns_ += kMs) {
    played_ = receiver_.play(now_ns_, kTool);
    ASSERT_TRUE(played_.cursor);
    if (*played_.cursor < 0.0) continue;
    EXPECT_EQ(played_.sample == nullptr, played_.index >= 3 * kBlock && played_.index < 5 * kBlock);
    missing += played_.sample == nullptr ? 1 : 0;
  }
  EXPECT_EQ(missing, 2 * kBlock);
}

TEST_F(CommandReceiverTest, WhileACorrectionGoesByTheMotionIsAsMuchSlower) {
  run(10);
  int slower = 0;
  for (int b = 0; b < 40; ++b) {
    receiver_.receive({next(), now_ns_ + 30 * kMs}, 4, now_ns_);  // a link that has become slower
    for (int n = 0; n < kBlock; ++n, now_ns_ += kMs) {
      const double before = *played_.cursor;
      played_ = receiver_.play(now_ns_, kTool);
      const double pace = *played_.cursor - before;
      if (played_.sample == nullptr || pace > 0.9) continue;
      EXPECT_NEAR(played_.state.velocity_m_per_s.x(), 1e-2 * pace, 1e-4);
      EXPECT_FALSE(played_.discontinuity);
      ++slower;
    }
  }
  EXPECT_GT(slower, 50);
}

/// The machine of both does something else now and then.
TEST_F(CommandReceiverTest, LateStepsOfBothSidesAreNeitherJitterNorCaughtUpWith) {
  double last = -1.0;
  const auto in_step = [&](const Played& played) {
    if (last >= 0.0) {
      EXPECT_DOUBLE_EQ(*played.cursor, last + 1.0);
    }
    last = *played.cursor;
  };
  for (int n = 0; n < 10; ++n) {
    run(3, in_step);
    now_ns_ += (7 * n % 40) * kMs;
    lost_ns_ += (7 * n % 40) * kMs;
  }
  EXPECT_EQ(receiver_.clock().depth_samples(), 21);
  EXPECT_EQ(receiver_.clock().corrections(), 0u);
}

/// The least that counts as lost.
TEST_F(CommandReceiverTest, AStepThatBothSidesLoseIsNoJitterEither) {
  for (int n = 0; n < 10; ++n) {
    run(3);
    now_ns_ += kMs;
    lost_ns_ += kMs;
  }
  EXPECT_EQ(receiver_.clock().depth_samples(), 21);
  EXPECT_EQ(receiver_.clock().corrections(), 0u);
}

/// However much it is in all, it is no delay: what is played stays as young as it was.
TEST_F(CommandReceiverTest, WhatTheSendersLoopLosesDoesNotAddUp) {
  run(600);
  const double before = *played_.cursor - static_cast<double>(sender_.next_tick());
  for (int n = 0; n < 40; ++n) {
    now_ns_ += 12 * kMs;
    for (int late = 12; late > 0; --late) played_ = receiver_.play(now_ns_ - late * kMs, kTool);
    lost_ns_ += 12 * kMs;
    run(12, [&](const Played& played) {
      EXPECT_EQ(played.discontinuity, false);
      EXPECT_FALSE(played.waits);
    });
  }
  EXPECT_EQ(receiver_.clock().depth_samples(), 21 + 12) << "it covers one loss: more of them than 0.5 %";
  EXPECT_NEAR(*played_.cursor - static_cast<double>(sender_.next_tick()), before - 12.0, 4.0);
}

/// Nor is what the receiver's own loop loses: it is caught up with.
TEST_F(CommandReceiverTest, WhatItsOwnLoopLosesIsCaughtUpWith) {
  run(100);
  const double before = *played_.cursor - static_cast<double>(sender_.next_tick());
  double behind = 0.0;
  for (int n = 0; n < 200; ++n) {
    receiver_.receive({next(), now_ns_}, 4, now_ns_);
    for (int step = 0; step < kBlock; ++step, now_ns_ += kMs) {
      if (n % 12 == 0 && step < 12) continue;
      played_ = receiver_.play(now_ns_, kTool);
      EXPECT_FALSE(played_.discontinuity);
      EXPECT_NE(played_.sample, nullptr);
    }
    behind = std::min(behind, *played_.cursor - static_cast<double>(sender_.next_tick()) - before);
  }
  EXPECT_GT(behind, -45.0) << "6 % of half a second, and one more";
  EXPECT_LT(behind, -12.0);
  EXPECT_EQ(receiver_.clock().depth_samples(), 21);
  EXPECT_EQ(receiver_.clock().resyncs(), 0u);
  run(200);
  EXPECT_NEAR(*played_.cursor - static_cast<double>(sender_.next_tick()), before, 4.0);
}

/// Nothing comes in the step in which it wakes.
TEST_F(CommandReceiverTest, AfterASleepWithoutAQueueItIsCaughtUpWithTooWithinASecondOrTwo) {
  run(100);
  const double before = *played_.cursor - static_cast<double>(sender_.next_tick());
  for (int b = 0; b < 12; ++b) {  // 192 ms are slept through, and what was sent then has come before
    receiver_.receive({next(), now_ns_}, 4, now_ns_ - b * kBlock * kMs);
    now_ns_ += kBlock * kMs;
  }
  played_ = receiver_.play(now_ns_++, kTool);
  EXPECT_LT(*played_.cursor - static_cast<double>(sender_.next_tick()), before - 150.0);
  run(150);
  EXPECT_NEAR(*played_.cursor - static_cast<double>(sender_.next_tick()), before, 5.0);
  EXPECT_EQ(receiver_.clock().resyncs(), 0u);
}

TEST_F(CommandReceiverTest, WhenTheLinkHasBecomeSlowerTimeStandsOnceAndThenThereIsAlwaysSomethingToPlay) {
  run(20);
  for (int n = 0; n < 60; ++n, now_ns_ += kMs) played_ = receiver_.play(now_ns_, kTool);
  EXPECT_TRUE(played_.waits);
  run(4);  // it stands for 80 ms at least
  run(35, [&](const Played& played) { EXPECT_NE(played.sample, nullptr); });
}

/// 30 ms in which samples may be late, and 80 in which the tool gets back to where it was led last.
TEST_F(CommandReceiverTest, WhereTimeHasToStandItStandsFor80Milliseconds) {
  run(20);
  int missing = 0, waiting = 0;
  const auto step = [&] {
    played_ = receiver_.play(now_ns_, kTool);
    now_ns_ += kMs;
    missing += played_.sample == nullptr ? 1 : 0;
    waiting += played_.waits ? 1 : 0;
  };
  for (int n = 0; n < 200 && !played_.waits; ++n) step();
  ASSERT_TRUE(played_.waits);
  EXPECT_EQ(missing, 30) << "brief ones leave a gap";
  while (played_.waits && waiting < 500) {  // everything is there at once
    if (waiting % kBlock == 1) receiver_.receive({next(), now_ns_}, 4, now_ns_);
    step();
  }
  EXPECT_EQ(waiting, 80);
}

}  // namespace
}  // namespace telekerf::streaming
