// SPDX-License-Identifier: Apache-2.0
// What a command block says besides its samples.
#include <gtest/gtest.h>

#include <bit>
#include <vector>

#include "common/protocol/wire_precision.h"
#include "master/command_stream.h"

namespace telekerf::master {
namespace {

constexpr int kBlock = 16;

class CommandStreamTest : public testing::Test {
 protected:
  CommandStreamTest() { master_.contour_id = 3; }
  static CommandStreamSettings positions() {
    CommandStreamSettings settings;
    settings.law = Law::kLocal;
    settings.codec = {.block = kBlock, .keep = 4, .redundancy = 2, .sample_period_ns = 1'000'000};
    return settings;
  }
  /// One block's ticks.
  CommandBlock block() {
    std::optional<CommandBlock> out;
    for (int n = 0; n < kBlock; ++n) {
      EXPECT_FALSE(out);
      master_.tool.position_m.x() += 1e-5;
      out = stream_.step(static_cast<std::int64_t>(tick_) * 1'000'000, tick_, master_);
      ++tick_;
    }
    EXPECT_TRUE(out);
    return out.value_or(CommandBlock{});
  }

  CommandStream stream_{positions(), 7};
  MasterSample master_;
  Tick tick_ = 0;
};

TEST_F(CommandStreamTest, EachBlockSaysWhetherTheSlaveIsLedAndWhetherItWasInThoseBefore) {
  const std::vector<bool> wanted = {false, true, true, false, true, true, true, true, true, true, true, true};
  unsigned before = 0;
  for (const bool engaged : wanted) {
    master_.engaged = engaged;
    const CommandBlock sent = block();
    EXPECT_EQ(sent.engaged, engaged) << sent.sequence;
    EXPECT_EQ(sent.engaged_before, before & 0x7FU) << sent.sequence;
    before = (before << 1U) | (engaged ? 1U : 0U);
  }
}

TEST_F(CommandStreamTest, AfterTicksThatWereLeftOutNothingOlderIsFollowed) {
  master_.engaged = true;
  for (int n = 0; n < 4; ++n) block();
  for (int n = 0; n < 5; ++n, ++tick_)
    EXPECT_FALSE(stream_.step(static_cast<std::int64_t>(tick_) * 1'000'000, tick_, master_));
  tick_ += 306;
  const Tick first = tick_;
  const CommandBlock after = block();
  EXPECT_EQ(after.first_tick, first) << "the five samples of before do not lead up to it";
  EXPECT_TRUE(after.engaged);
  EXPECT_EQ(after.engaged_before, 0u) << "its copies are not of the ticks before it";
  EXPECT_EQ(block().engaged_before, 1u);
}

/// States that all came, or all but the last so many before the newest.
void tell_states(CommandStream& stream, std::uint32_t& number, int missing) {
  streaming::Feedback feedback;
  feedback.kind = streaming::Arrival::Kind::kNew;
  feedback.ours = true;
  number += static_cast<std::uint32_t>(missing);
  for (int n = 0; n < 40; ++n) {
    feedback.number = ++number;
    stream.received(feedback);
  }
}

TEST_F(CommandStreamTest, PacketsCarryMoreCopiesAfterABurstOfLosses) {
  std::uint32_t number = 0;
  tell_states(stream_, number, 0);
  for (int n = 0; n < 10; ++n) block();
  EXPECT_EQ(stream_.copies(), 2) << "redundancy";
  tell_states(stream_, number, 3);
  block();
  EXPECT_EQ(stream_.copies(), 6);
  stream_.change({.block = kBlock, .redundancy = 1, .sample_period_ns = 1'000'000});
  for (int n = 0; n < 10; ++n) block();
  EXPECT_EQ(stream_.copies(), 1) << "other settings, another start";
}

TEST_F(CommandStreamTest, ALoopThatSpansTheDelayWaitsForNoMoreCopies) {
  struct Row {
    Law law;
    const char* estimator;
    int copies;
  };
  for (const Row& row : {Row{Law::kRemoteAcceleration, "predictor", 2}, Row{Law::kAnchored, "thesis", 2},
                         Row{Law::kAnchored, "predictor", 7}, Row{Law::kLocal, "none", 7}}) {
    CommandStreamSettings settings = positions();
    settings.law = row.law;
    settings.observer.estimator = estimator_named(row.estimator);
    settings.codec.anchored = row.law == Law::kLocal;
    stream_ = CommandStream(settings, 7);
    std::uint32_t number = 0;
    tell_states(stream_, number, 0);
    tell_states(stream_, number, 9);
    for (int n = 0; n < 10; ++n) block();
    EXPECT_EQ(stream_.copies(), row.copies) << row.estimator;
  }
}

TEST_F(CommandStreamTest, AsManyCopiesAsItsSettingsAllowAndNoneOfSingleSamples) {
  for (const int max : {0, 4}) {
    for (const int length : {kBlock, 1}) {
      CommandStreamSettings settings = positions();
      settings.max_redundancy = max;
      settings.codec.block = length;
      if (length == 1) settings.codec = codec::with_codec(settings.codec, "raw");
      stream_ = CommandStream(settings, 7);
      std::uint32_t number = 0;
      tell_states(stream_, number, 0);
      tell_states(stream_, number, 9);
      for (int n = 0; n < 10 * kBlock; ++n) (void)stream_.step(0, tick_++, master_);
      EXPECT_EQ(stream_.copies(), length == 1 ? 0 : std::max(max, 2)) << max << ' ' << length;
    }
  }
}

TEST_F(CommandStreamTest, ABlockNamesItsSenderItsPlaceInTimeAndWhatItIsFor) {
  for (std::uint32_t n = 0; n < 3; ++n) {
    const CommandBlock sent = block();
    EXPECT_EQ(sent.epoch, 7u);
    EXPECT_EQ(sent.sequence, n + 1);
    EXPECT_EQ(sent.first_tick, n * kBlock);
    EXPECT_EQ(sent.sample_period_ns, 1'000'000u);
    EXPECT_EQ(sent.contour_id, 3u);
    EXPECT_EQ(sent.beta, 1.0);
    EXPECT_EQ(sent.law, Law::kLocal);
    EXPECT_EQ(sent.sent_ns, static_cast<std::int64_t>(tick_ - 1) * 1'000'000);
    EXPECT_NEAR(sent.anchor.position_m.x(), 1e-5 * (n * kBlock + 1), 0.5 * kPositionGrid_m);
  }
}

TEST_F(CommandStreamTest, TheButtonIsOnItsSamplesAloneAndNeverBeforeTheSlaveIsLed) {
  master_.button = true;
  EXPECT_EQ(block().button, 0u) << "nobody is led";
  master_.engaged = true;
  EXPECT_EQ(block().button, 0xFFFFu);
  std::optional<CommandBlock> out;
  for (int n = 0; n < kBlock; ++n, ++tick_) {
    master_.button = n >= 5 && n < 9;
    out = stream_.step(static_cast<std::int64_t>(tick_) * 1'000'000, tick_, master_);
  }
  ASSERT_TRUE(out);
  EXPECT_EQ(out->button, 0b0000'0001'1110'0000u);
  master_.engaged = false;
  master_.button = true;
  EXPECT_EQ(block().button, 0u);
}

TEST_F(CommandStreamTest, AnotherScaleComesWithABlockAndWhatWasBeforeIsNothingToFollow) {
  master_.engaged = true;
  block();
  block();
  master_.beta = 0.25;
  master_.tool.position_m = Vec3(4e-3, 0, 0);
  const CommandBlock sent = block();
  EXPECT_EQ(sent.beta, 0.25);
  EXPECT_TRUE(sent.engaged);
  EXPECT_EQ(sent.engaged_before, 0u) << "copies of blocks with the scale before";
  EXPECT_NEAR(sent.anchor.position_m.x(), 0.25 * 4.01e-3, 0.5 * kPositionGrid_m);
  EXPECT_EQ(block().engaged_before, 1u);
}

}  // namespace
}  // namespace telekerf::master
