// SPDX-License-Identifier: Apache-2.0
// The force on the slave's tool as it reaches the master: nothing twice, nothing late, nothing made up.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "common/codec/encoder.h"
#include "master/force_feedback.h"

namespace telekerf::master {
namespace {

constexpr double kMaxRms = 0.02;
constexpr int kBlock = 16;

Vec3 force_at(std::int64_t index) {
  const double t = static_cast<double>(index) * 1e-3;
  return {2.0 * std::sin(7.0 * t), -1.0 + 0.3 * std::sin(40.0 * t + 1.0), 0.5 * std::cos(3.0 * t)};
}

/// A slave that reports a known force, a block at a time.
class ForceFeedbackTest : public testing::Test {
 protected:
  StateBlock next() {
    StateBlock state;
    state.epoch = epoch_;
    state.sequence = ++number_;
    state.first_tick = static_cast<Tick>(index_);
    state.sample_period_ns = 1'000'000;
    std::vector<Vec3> samples(static_cast<std::size_t>(encoder_.settings().block));
    for (Vec3& sample : samples) sample = force_at(index_++);
    state.force.size =
        static_cast<std::uint16_t>(encoder_.encode(samples, 0, {}, state.force.room()).value_or(0));
    EXPECT_GT(state.force.size, 0);
    std::fill(samples.begin(), samples.end(), Vec3::Zero());
    state.payload.size =
        static_cast<std::uint16_t>(positions_.encode(samples, 0, {}, state.payload.room()).value_or(0));
    return state;
  }
  void receive(const StateBlock& state) {
    const streaming::Feedback& feedback = states_.receive({state, now_ns_});
    feedback_.received(feedback, states_.header());
  }
  SlaveForce step() {
    now_ns_ += 1'000'000;
    return feedback_.step(1e-3);
  }
  /// One block's time; true if nothing but the wanted force was given out.
  void play(int steps = kBlock) {
    for (int n = 0; n < steps; ++n) {
      out_ = step();
      if (!out_.known) continue;
      const Vec3 error = out_.force_n - force_at(static_cast<std::int64_t>(out_.tick));
      worst_ = std::max(worst_, error.cwiseAbs().maxCoeff());
      skipped_ += out_.tick > last_ + 1 ? 1 : 0;
      held_ += out_.tick == last_ ? 1 : 0;
      EXPECT_GE(out_.tick, last_);
      last_ = out_.tick;
    }
  }

  codec::BlockEncoder encoder_{
      {.block = kBlock, .max_rms = kMaxRms, .redundancy = 1, .quantum = 0.01, .anchored = false}};
  codec::BlockEncoder positions_{codec::StreamSettings{}};
  streaming::StateReceiver states_{0.5, 1, 1};
  ForceFeedback feedback_;
  std::uint32_t epoch_ = 3;
  std::int64_t now_ns_ = 0;
  SlaveForce out_;
  std::uint32_t number_ = 0;
  std::int64_t index_ = 0;
  Tick last_ = 0;
  double worst_ = 0.0;
  int skipped_ = 0;
  int held_ = 0;
};

TEST_F(ForceFeedbackTest, EveryBlocksErrorIsWithinThePromiseAndEverySampleIsGivenOutOnce) {
  for (int b = 0; b < 100; ++b) {
    receive(next());
    Vec3 squares = Vec3::Zero();
    for (int n = 0; n < kBlock; ++n) {
      out_ = step();
      ASSERT_EQ(out_.tick, static_cast<Tick>(b * kBlock + n));
      squares += (out_.force_n - force_at(b * kBlock + n)).cwiseAbs2();
    }
    ASSERT_LE(std::sqrt(squares.maxCoeff() / kBlock), kMaxRms) << "block " << b;
  }
}

TEST_F(ForceFeedbackTest, ALostBlockIsCoveredByTheNextOnesCopyAndCaughtUp) {
  for (int b = 0; b < 40; ++b) {
    const StateBlock state = next();
    if (b % 8 != 5) receive(state);
    play();
  }
  EXPECT_LT(worst_, std::sqrt(double(kBlock)) * kMaxRms);
  EXPECT_EQ(held_, 1 + 5 * kBlock) << "at tick 0, and while a block was missing";
  EXPECT_EQ(skipped_, 5 * kBlock) << "at double pace afterwards";
  EXPECT_EQ(last_, static_cast<Tick>(index_ - 1));
}

TEST_F(ForceFeedbackTest, WithoutCopiesTheLastValueIsHeldAndTheRestIsTrue) {
  std::int64_t shown_before = 0;
  for (int b = 0; b < 40; ++b) {
    const StateBlock state = next();
    if (b % 8 < 5) receive(state);
    for (int n = 0; n < kBlock; ++n) {
      out_ = step();
      const auto shown = static_cast<std::int64_t>(out_.tick);
      ASSERT_GE(shown, shown_before) << "block " << b;
      shown_before = shown;
      // What the slave said of that very tick (the last of three lost blocks has a copy), or the last thing
      // before.
      const std::int64_t block = shown / kBlock;
      const std::int64_t said =
          block % 8 < 5 || block % 8 == 7 ? shown : (block - block % 8 + 5) * kBlock - 1;
      ASSERT_LT((out_.force_n - force_at(said)).cwiseAbs().maxCoeff(), 0.1)
          << "tick " << shown << ", block " << b;
    }
  }
}

TEST_F(ForceFeedbackTest, RepeatedLateAndBrokenBlocksChangeNothing) {
  const StateBlock first = next();
  const StateBlock late = next();
  const StateBlock second = next();
  receive(first);
  play(4);
  receive(first);
  play(12);
  EXPECT_EQ(last_, 15u);
  receive(second);
  StateBlock broken = next();
  broken.force.size /= 2;
  receive(broken);
  broken = next();
  broken.force.bytes[0] ^= 0xF0U;
  receive(broken);
  receive(late);
  StateBlock none = next();
  none.force.size = 0;
  receive(none);
  play(60);
  EXPECT_EQ(last_, 47u);
  EXPECT_LT(worst_, std::sqrt(double(kBlock)) * kMaxRms);
  EXPECT_EQ(states_.force_counters().of(codec::CodecError::kTruncated), 1u);
  EXPECT_EQ(states_.force_counters().of(codec::CodecError::kWrongVersion), 1u);
}

TEST_F(ForceFeedbackTest, OtherSettingsAnotherRateAndARestartedSlaveAreFollowed) {
  receive(next());
  play();
  encoder_.change({.block = 32, .keep = 12, .redundancy = 2, .quantum = 1e-3, .anchored = false});
  positions_.change({.block = 32});
  receive(next());
  play(32);
  EXPECT_EQ(last_, 47u);
  EXPECT_EQ(skipped_, 0);
  EXPECT_EQ(held_, 1) << "the very first tick is 0";

  StateBlock slower = next();
  slower.sample_period_ns = 2'000'000;
  slower.ticks_per_sample = 2;
  slower.first_tick = 100;
  receive(slower);
  for (int n = 0; n < 64; ++n) out_ = step();
  EXPECT_EQ(out_.tick, 162u) << "32 samples of two ticks";

  now_ns_ += 1'000'000'000;
  epoch_ = 4;
  StateBlock other = next();
  other.sequence = 1;
  other.first_tick = 0;
  receive(other);
  out_ = step();
  EXPECT_EQ(out_.tick, 0u);
}

TEST_F(ForceFeedbackTest, SilenceMakesItUnknown) {
  EXPECT_FALSE(step().known);
  receive(next());
  EXPECT_TRUE(step().known);
  for (int n = 0; n < 600; ++n) out_ = step();
  EXPECT_FALSE(out_.known);
  receive(next());
  int known = 0;
  for (int n = 0; n < 600; ++n) known += step().known ? 1 : 0;
  EXPECT_NEAR(known, 499, 1) << "half a second";
}

TEST_F(ForceFeedbackTest, WhatLiesBehindIsCaughtUpAtDoublePaceAndNeverPassesTheNewest) {
  receive(next());
  play();
  (void)next();
  receive(next());  // with the copy of the lost one: 32 samples at once
  std::vector<Tick> shown;
  for (int n = 0; n < 40; ++n) shown.push_back(step().tick);
  for (std::size_t n = 0; n < shown.size(); ++n) {
    // Due is one block behind the newest, where it begins; two samples a step until that is reached.
    const std::size_t caught_up = std::min<std::size_t>(15 + 2 * (n + 1), 31 + n + 1);
    EXPECT_EQ(shown[n], std::min<std::size_t>(caught_up, 47)) << n;
  }
}

TEST_F(ForceFeedbackTest, AnotherRateIsGivenOutAtItsOwnPace) {
  StateBlock slow = next();
  slow.sample_period_ns = 4'000'000;
  slow.ticks_per_sample = 4;
  receive(slow);
  for (int n = 0; n < 64; ++n) {
    out_ = step();
    ASSERT_EQ(out_.tick, static_cast<Tick>(4 * std::max(0, (n - 3) / 4))) << n;
  }
  EXPECT_TRUE(out_.known);
}

}  // namespace
}  // namespace telekerf::master
