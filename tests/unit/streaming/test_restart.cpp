// SPDX-License-Identifier: Apache-2.0
// A peer that starts again: nothing that its predecessor said may be taken for its own.
#include <gtest/gtest.h>

#include "common/streaming/command_receiver.h"
#include "common/streaming/state_receiver.h"
#include "tests/unit/streaming/blocks.h"

namespace telekerf::streaming {
namespace {

const KinematicState kTool;
constexpr std::int64_t kSilence_ns = 600 * kMs;

class Restart : public testing::Test {
 protected:
  CommandBlock next(Sender<CommandBlock>& sender, bool button) {
    sender.button = button ? 0xFFFF : 0;
    CommandBlock block = sender.next();
    block.engaged = true;
    block.engaged_before = 0x7F;
    return block;
  }
  /// Blocks as they fill, played step by step.
  Played run(Sender<CommandBlock>& sender, int blocks, bool button) {
    Played played;
    for (int b = 0; b < blocks; ++b) {
      receiver_.receive({next(sender, button), now_ns_}, 4, now_ns_);
      for (int n = 0; n < kBlock; ++n, now_ns_ += kMs) played = receiver_.play(now_ns_, kTool);
    }
    return played;
  }

  CommandReceiver receiver_{{}};
  Sender<CommandBlock> before_{7};
  Sender<CommandBlock> after_{8};
  std::int64_t now_ns_ = 15 * kMs;
};

TEST_F(Restart, ThePressedButtonOfTheMasterBeforeIsForgotten) {
  ASSERT_TRUE(run(before_, 20, true).sample->button);
  now_ns_ += kSilence_ns;
  // The new master counts from 0 again: every place was held by a sample of the old one with its button
  // pressed.
  for (int b = 0; b < 12; ++b) {
    receiver_.receive({next(after_, false), now_ns_}, 4, now_ns_);
    for (int n = 0; n < kBlock; ++n, now_ns_ += kMs) {
      const Played played = receiver_.play(now_ns_, kTool);
      EXPECT_EQ(played.begins, b == 0 && n == 0);
      if (played.sample == nullptr) continue;
      EXPECT_FALSE(played.sample->button) << b << " " << n;
      EXPECT_EQ(played.sample->generation, 2u);
    }
  }
}

TEST_F(Restart, WhatTheMasterBeforeSaidOfLaterTicksIsNotThere) {
  ASSERT_TRUE(run(before_, 20, true).sample->button);
  now_ns_ += kSilence_ns;
  Played played = run(after_, 1, false);
  // Then it falls silent: the samples that are due next were only the old master's.
  for (int n = 0; n < 60; ++n, now_ns_ += kMs) {
    played = receiver_.play(now_ns_, kTool);
    ASSERT_TRUE(played.cursor);
    if (*played.cursor >= kBlock) {
      EXPECT_EQ(played.sample, nullptr) << *played.cursor;
    }
  }
  EXPECT_TRUE(played.waits);
  EXPECT_EQ(*played.cursor, kBlock) << "time stands until they come";
}

TEST_F(Restart, ItsTimeIsCountedFromItsOwnFirstBlock) {
  for (int b = 0; b < 20; ++b) {
    const std::int64_t waited_ns = b % 2 == 0 ? 0 : 30 * kMs;  // the old one's link shook
    receiver_.receive({next(before_, true), now_ns_ - waited_ns}, 4, now_ns_);
    for (int n = 0; n < kBlock; ++n, now_ns_ += kMs) (void)receiver_.play(now_ns_, kTool);
  }
  ASSERT_GT(receiver_.clock().depth_samples(), 40);
  now_ns_ += kSilence_ns;
  receiver_.receive({next(after_, false), now_ns_}, 4, now_ns_);
  for (int n = 0; n < kBlock; ++n, now_ns_ += kMs) {
    const Played played = receiver_.play(now_ns_, kTool);
    ASSERT_TRUE(played.cursor);
    // Sample 15 came now, and is due 15 + 4 + 2 ms later.
    EXPECT_EQ(*played.cursor, static_cast<double>(n - 6)) << n;
  }
  EXPECT_EQ(receiver_.clock().depth_samples(), kBlock - 1 + 4 + 2);
}

TEST_F(Restart, ItsOvertakenBlocksAreOfUseAlthoughTheOldMasterWasFurther) {
  run(before_, 20, true);
  now_ns_ += kSilence_ns;
  receiver_.receive({next(after_, false), now_ns_}, 4, now_ns_);
  const CommandBlock overtaken = next(after_, false);
  (void)next(after_, false);
  receiver_.receive({next(after_, false), now_ns_}, 4, now_ns_);
  const StreamCounters counters = receiver_.counters();
  receiver_.receive({overtaken, now_ns_}, 4, now_ns_);
  EXPECT_EQ(receiver_.counters().blocks, counters.blocks + 1);
  EXPECT_EQ(receiver_.counters().stale, counters.stale);
}

TEST(RestartOfASlave, ItsPositionsAndForcesAreTakenFromItsFirstBlockOn) {
  StateReceiver receiver(0.5, 99, 1);
  std::int64_t now_ns = 0;
  for (const std::uint32_t epoch : {5u, 6u}) {
    Sender<StateBlock> sender(epoch);
    codec::BlockEncoder forces({.max_rms = 0.01, .redundancy = 1, .quantum = 1e-3, .anchored = false});
    for (int b = 0; b < 10; ++b, now_ns += kBlock * kMs) {
      StateBlock block = sender.next();
      const std::vector<Vec3> pushed(kBlock, Vec3(epoch, 0, 0));
      block.force.size =
          static_cast<std::uint16_t>(forces.encode(pushed, 0, {}, block.force.room()).value_or(0));
      const Feedback& feedback = receiver.receive({block, now_ns});
      EXPECT_EQ(feedback.begins, b == 0);
      ASSERT_EQ(feedback.samples.size(), static_cast<std::size_t>(kBlock)) << epoch << " " << b;
      EXPECT_EQ(feedback.samples.front().time, b * kBlock);
      ASSERT_TRUE(feedback.force_n) << epoch << " " << b;
      EXPECT_NEAR(feedback.force_n->at(b * kBlock).x(), epoch, 0.05);
    }
    now_ns += kSilence_ns;
  }
}

}  // namespace
}  // namespace telekerf::streaming
