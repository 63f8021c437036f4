// SPDX-License-Identifier: Apache-2.0
// The master's end of the state stream: every sample once and in order, whatever the link does.
#include <gtest/gtest.h>

#include <vector>

#include "common/codec/settings.h"
#include "common/streaming/state_receiver.h"
#include "tests/unit/allocations.h"
#include "tests/unit/streaming/blocks.h"

namespace telekerf::streaming {
namespace {

class StateReceiverTest : public ::testing::Test {
 protected:
  StateBlock next() {
    StateBlock block = sender_.next();
    block.master_epoch = 3;
    block.applied_tick = block.first_tick + kBlock - 1 - 40;  // 40 ticks ago
    block.applied_bitmap = ~std::uint64_t{0};
    return block;
  }
  /// Takes the block; checks that its samples follow those before.
  const Feedback& take(const StateBlock& block) {
    const Feedback& feedback = receiver_.receive({block, now_ns_});
    now_ns_ += kBlock * kMs;
    for (const SlaveSample& sample : feedback.samples) {
      EXPECT_GT(sample.time, newest_);
      skipped_ += static_cast<int>(sample.time - newest_ - 1);
      newest_ = sample.time;
      EXPECT_LT((sample.position_m - place(sample.time)).norm(), 1e-6);
      EXPECT_NEAR(sample.velocity_m_per_s.x(), 1e-2, 1e-3);
      EXPECT_EQ(sample.index, sample.time - 40);
    }
    return feedback;
  }

  StateReceiver receiver_{0.5, 3, 1};
  Sender<StateBlock> sender_{7};
  std::int64_t now_ns_ = 0;
  std::int64_t newest_ = -1;
  int skipped_ = 0;
};

TEST_F(StateReceiverTest, ARecordingHeardFirstGivesWayToWhoFollowsUs) {
  StateBlock recorded = next();
  recorded.master_epoch = 2;  // the master of before
  for (int n = 0; n < 400; ++n) (void)next();
  EXPECT_EQ(receiver_.receive({recorded, now_ns_}).kind, Arrival::Kind::kNew);
  StateBlock live = next();
  live.master_epoch = 2;
  EXPECT_EQ(receiver_.receive({live, now_ns_}).kind, Arrival::Kind::kRefused);
  live = next();
  const Feedback& feedback = receiver_.receive({live, now_ns_});
  EXPECT_EQ(feedback.kind, Arrival::Kind::kNew);
  EXPECT_TRUE(feedback.ours);
  EXPECT_EQ(receiver_.receive({recorded, now_ns_}).kind, Arrival::Kind::kStale);
}

TEST_F(StateReceiverTest, LostBlocksComeByTheirCopiesAndNothingComesTwice) {
  for (int n = 0; n < 60; ++n) {
    const StateBlock block = next();
    if (n % 5 == 3) continue;
    EXPECT_EQ(take(block).samples.size(), n % 5 == 4 ? 2u * kBlock : kBlock);
  }
  EXPECT_EQ(newest_, 60 * kBlock - 1);
  EXPECT_EQ(skipped_, 0);
  EXPECT_EQ(receiver_.counters().lost, 12u);
}

TEST_F(StateReceiverTest, WhatWasOvertakenBringsNothing) {
  take(next());
  const StateBlock late = next();
  take(next());
  EXPECT_TRUE(take(late).samples.empty());
  EXPECT_EQ(receiver_.receive({late, now_ns_}).kind, Arrival::Kind::kStale);
  EXPECT_EQ(newest_, 3 * kBlock - 1);
}

TEST_F(StateReceiverTest, ASlaveOfAnotherMasterIsSeenButHasAppliedNothingOfOurs) {
  StateBlock block = next();
  EXPECT_TRUE(take(block).samples.back().applied);
  block = next();
  block.master_epoch = 99;
  const Feedback& feedback = take(block);
  EXPECT_FALSE(feedback.ours);
  ASSERT_EQ(feedback.samples.size(), static_cast<std::size_t>(kBlock));
  for (const SlaveSample& sample : feedback.samples) EXPECT_FALSE(sample.applied);
}

TEST_F(StateReceiverTest, ForcesComeWithTheirIndexAndBrokenOnesCostNoPosition) {
  codec::BlockEncoder forces({.max_rms = 0.01, .redundancy = 1, .quantum = 1e-3, .anchored = false});
  const auto with_force = [&] {
    StateBlock block = next();
    const std::vector<Vec3> pushed(kBlock, Vec3(2.0, -1.0, 0.5));
    block.force.size =
        static_cast<std::uint16_t>(forces.encode(pushed, 0, {}, block.force.room()).value_or(0));
    return block;
  };
  EXPECT_FALSE(take(next()).force_n);
  const Feedback& pushed = take(with_force());
  ASSERT_TRUE(pushed.force_n);
  EXPECT_EQ(pushed.force_n->first(), kBlock);
  EXPECT_NEAR(pushed.force_n->at(kBlock + 3).x(), 2.0, 0.05);
  StateBlock broken = with_force();
  broken.force.size /= 2;
  const Feedback& half = take(broken);
  EXPECT_FALSE(half.force_n);
  EXPECT_EQ(half.samples.size(), static_cast<std::size_t>(kBlock));
  EXPECT_EQ(receiver_.force_counters().of(codec::CodecError::kTruncated), 1u);
}

TEST_F(StateReceiverTest, ForcesThatComeTwiceAreRefusedUntilAnotherSlaveSendsThem) {
  codec::BlockEncoder forces({.max_rms = 0.01, .redundancy = 0, .quantum = 1e-3, .anchored = false});
  const std::vector<Vec3> pushed(kBlock, Vec3(2.0, -1.0, 0.5));
  StateBlock block = next();
  block.force.size = static_cast<std::uint16_t>(forces.encode(pushed, 0, {}, block.force.room()).value_or(0));
  EXPECT_TRUE(take(block).force_n);
  StateBlock again = next();
  again.force = block.force;
  EXPECT_FALSE(take(again).force_n);
  EXPECT_EQ(receiver_.force_counters().of(codec::CodecError::kReplayed), 1u);
  now_ns_ += 600 * kMs;
  Sender<StateBlock> restarted(8);
  StateBlock others = restarted.next();
  others.force = block.force;
  const Feedback& feedback = receiver_.receive({others, now_ns_});
  EXPECT_TRUE(feedback.begins);
  EXPECT_TRUE(feedback.force_n) << "the same number, of another count";
}

TEST_F(StateReceiverTest, CopiesFromBeforeTheFirstTickAreNoSamples) {
  (void)next();
  StateBlock block = next();
  block.first_tick = 0;
  const Feedback& feedback = receiver_.receive({block, now_ns_});
  ASSERT_EQ(feedback.samples.size(), static_cast<std::size_t>(kBlock));
  EXPECT_EQ(feedback.samples.front().time, 0);
}

TEST_F(StateReceiverTest, ARestartedSlaveIsListenedToAfterASilence) {
  take(next());
  Sender<StateBlock> restarted(8);
  EXPECT_EQ(receiver_.receive({restarted.next(), now_ns_}).kind, Arrival::Kind::kRefused);
  const Feedback& refused = receiver_.receive({restarted.next(), now_ns_});
  EXPECT_FALSE(refused.begins || refused.ours);
  now_ns_ += 600 * kMs;
  const Feedback& feedback = receiver_.receive({restarted.next(), now_ns_});
  EXPECT_TRUE(feedback.begins);
  ASSERT_FALSE(feedback.samples.empty());
  EXPECT_EQ(feedback.samples.back().time, 3 * kBlock - 1);
}

TEST(StateReceiverMemory, TheLongestBlockIsTakenWithoutAllocating) {
  codec::StreamSettings settings;
  settings.max_rms = 1e-6;
  settings.block = codec::kMaxBlock;
  settings.redundancy = codec::kMaxRedundancy;
  codec::BlockEncoder encoder(settings.validated());
  StateReceiver receiver(0.5, 3, 1);
  std::vector<StateBlock> blocks(9);
  Tick tick = 0;
  for (StateBlock& block : blocks) {
    block.sequence = 1 + static_cast<std::uint32_t>(&block - blocks.data());
    block.sample_period_ns = 1'000'000;
    block.ticks_per_sample = 1;
    block.first_tick = tick;
    std::vector<Vec3> samples;
    for (int n = 0; n < codec::kMaxBlock; ++n) samples.push_back(place(static_cast<std::int64_t>(tick++)));
    block.payload.size =
        static_cast<std::uint16_t>(encoder.encode(samples, 0, {}, block.payload.room()).value_or(0));
    ASSERT_GT(block.payload.size, 0);
  }
  const std::uint64_t before = telekerf::testing::allocations();
  const std::size_t first = receiver.receive({blocks[0], 0}).samples.size();
  // Seven are lost; their copies come with the ninth, after a wait that allows its stamp.
  const std::size_t rest = receiver.receive({blocks[8], 400 * kMs}).samples.size();
  EXPECT_EQ(telekerf::testing::allocations(), before);
  EXPECT_EQ(first, static_cast<std::size_t>(codec::kMaxBlock));
  EXPECT_EQ(rest, static_cast<std::size_t>(8 * codec::kMaxBlock));
}

/// A parabola in single precision, at 500 Hz: differences of second order are exact to the ends of a block.
TEST(StateVelocities, AreOfSecondOrderAlsoAtABlocksEnds) {
  const auto place_m = [](double t_s) {
    return Vec3(2e-3 + 0.02 * t_s + 1.5 * t_s * t_s, -0.5 * t_s * t_s, 0.0);
  };
  for (const int block_size : {1, 2, 3, 16}) {
    codec::StreamSettings settings;
    settings = codec::with_codec(settings, "batched");
    settings.block = block_size;
    settings.redundancy = 0;
    settings.anchored = false;
    settings.sample_period_ns = 2'000'000;
    codec::BlockEncoder encoder(settings);
    StateReceiver receiver(0.5, 3, 1);
    StateBlock block;
    block.sequence = 1;
    block.sample_period_ns = 2'000'000;
    block.ticks_per_sample = 2;
    block.anchor.velocity_m_per_s = Vec3(7, 8, 9);
    block.first_tick = 40;
    std::vector<Vec3> samples;
    for (int n = 0; n < block_size; ++n) samples.push_back(place_m(2e-3 * n));
    codec::Trend trend{Vec3::Zero(), 2e-3 * block.anchor.velocity_m_per_s};
    block.payload.size =
        static_cast<std::uint16_t>(encoder.encode(samples, 0, trend, block.payload.room()).value_or(0));
    const Feedback& feedback = receiver.receive({block, 0});
    ASSERT_EQ(feedback.samples.size(), static_cast<std::size_t>(block_size));
    for (int n = 0; n < block_size; ++n) {
      const SlaveSample& sample = feedback.samples[static_cast<std::size_t>(n)];
      EXPECT_EQ(sample.time, 20 + n);
      const Vec3 wanted = block_size < 3 ? Vec3(7, 8, 9) : Vec3(0.02 + 3.0 * 2e-3 * n, -2e-3 * n, 0.0);
      EXPECT_LT((sample.velocity_m_per_s - wanted).norm(), 2e-6) << n << " of " << block_size;
    }
  }
}

TEST_F(StateReceiverTest, SamplesBelongToTheCommandsThatWereAppliedThen) {
  StateBlock block = next();
  block.applied_tick = 300;
  block.applied_age_ticks = 3;
  block.applied_bitmap = 0b1011;
  const Feedback& feedback = receiver_.receive({block, now_ns_});
  ASSERT_EQ(feedback.samples.size(), static_cast<std::size_t>(kBlock));
  for (int back = 0; back < kBlock; ++back) {
    const SlaveSample& sample = feedback.samples[static_cast<std::size_t>(kBlock - 1 - back)];
    EXPECT_EQ(sample.index, 303 - back);
    EXPECT_EQ(sample.applied, back == 3 || back == 4 || back == 6) << back;
  }
}

}  // namespace
}  // namespace telekerf::streaming
