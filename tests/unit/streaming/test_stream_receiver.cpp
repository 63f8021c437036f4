// SPDX-License-Identifier: Apache-2.0
// Order and epoch, judged in one place for both streams: what is new, late, lost, repeated or refused.
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "common/streaming/packet_samples.h"
#include "common/streaming/stream_receiver.h"
#include "tests/unit/streaming/blocks.h"

namespace telekerf::streaming {
namespace {

using Kind = Arrival::Kind;
constexpr std::int64_t kAlways = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

template <class Block>
class StreamReceiverTest : public testing::Test {
 protected:
  /// Every 16 ms one.
  Kind take(const Block& block, std::int64_t useful_from = kAlways) {
    last_ = receiver_.receive({block, now_ns_}, useful_from);
    now_ns_ += kBlock * kMs;
    return last_.kind;
  }

  StreamReceiver<Block> receiver_{0.15};
  Sender<Block> sender_{7};
  Arrival last_;
  std::int64_t now_ns_ = 1000 * kMs;
};

using Blocks = testing::Types<CommandBlock, StateBlock>;
TYPED_TEST_SUITE(StreamReceiverTest, Blocks);

TYPED_TEST(StreamReceiverTest, BlocksInOrderAreNewAndCarryTheirSamples) {
  EXPECT_FALSE(this->receiver_.heard());
  for (int n = 0; n < 20; ++n) {
    ASSERT_EQ(this->take(this->sender_.next()), Kind::kNew);
    EXPECT_EQ(this->last_.begins, n == 0);
    EXPECT_EQ(this->last_.missing, 0u);
    const PacketSamples samples(*this->last_.packet, this->last_.first);
    EXPECT_EQ(samples.last(), n * kBlock + 15);
    EXPECT_EQ(samples.oldest(), n == 0 ? 0 : (n - 1) * kBlock) << "with its copy";
    for (std::int64_t i = samples.oldest(); i <= samples.last(); ++i) {
      ASSERT_LT((samples.at(i) - place(i)).norm(), 1e-6) << i;
    }
  }
  EXPECT_TRUE(this->receiver_.heard());
  EXPECT_EQ(this->receiver_.header().sequence, 20u);
  EXPECT_EQ(this->receiver_.generation(), 1u);
  EXPECT_EQ(this->receiver_.counters().blocks, 20u);
}

TYPED_TEST(StreamReceiverTest, MissingBlocksAreLostUntilTheyComeLate) {
  this->take(this->sender_.next());
  const TypeParam second = this->sender_.next();
  const TypeParam third = this->sender_.next();
  EXPECT_EQ(this->take(this->sender_.next()), Kind::kNew);
  EXPECT_EQ(this->last_.missing, 2u);
  EXPECT_EQ(this->receiver_.counters().lost, 2u);
  EXPECT_EQ(this->take(third), Kind::kLate);
  EXPECT_EQ(this->last_.first, 2 * kBlock);
  ASSERT_NE(this->last_.packet, nullptr);
  EXPECT_EQ(this->receiver_.header().sequence, 4u) << "the newest one's header stays";
  EXPECT_EQ(this->receiver_.counters().lost, 1u);
  EXPECT_EQ(this->take(second, kNever), Kind::kStale) << "nobody can use it any more";
  EXPECT_EQ(this->last_.packet, nullptr);
  EXPECT_EQ(this->receiver_.counters().lost, 1u);
  EXPECT_EQ(this->receiver_.counters().stale, 1u);
}

TYPED_TEST(StreamReceiverTest, WhatIsRepeatedOrFromBeforeTheBeginningIsStaleAndNeverLost) {
  const TypeParam before = this->sender_.next();
  const TypeParam first = this->sender_.next();
  this->take(first);
  EXPECT_EQ(this->take(first), Kind::kStale);
  EXPECT_EQ(this->take(before), Kind::kStale);
  const TypeParam third = this->sender_.next();
  this->take(this->sender_.next());
  EXPECT_EQ(this->take(third), Kind::kLate);
  EXPECT_EQ(this->take(third), Kind::kStale) << "the second time";
  EXPECT_EQ(this->receiver_.counters().lost, 0u);
  EXPECT_EQ(this->receiver_.counters().stale, 3u);
}

TYPED_TEST(StreamReceiverTest, NumbersWrapAround) {
  Sender<TypeParam> sender(7, std::numeric_limits<std::uint32_t>::max() - 2);
  this->take(sender.next());
  this->take(sender.next());
  const TypeParam overtaken = sender.next();  // the largest number
  EXPECT_EQ(this->take(sender.next()), Kind::kNew) << "number 0";
  EXPECT_EQ(this->last_.missing, 1u);
  EXPECT_EQ(this->take(overtaken), Kind::kLate);
  EXPECT_EQ(this->take(sender.next()), Kind::kNew);
  EXPECT_EQ(this->last_.missing, 0u);
  EXPECT_EQ(this->receiver_.counters().lost, 0u);
}

TYPED_TEST(StreamReceiverTest, AnotherSenderKnocksInVainUntilOursIsSilent) {
  Sender<TypeParam> other(8);
  this->take(this->sender_.next());
  EXPECT_EQ(this->take(other.next()), Kind::kRefused);
  EXPECT_EQ(this->take(this->sender_.next()), Kind::kNew);
  this->now_ns_ += 200 * kMs;
  EXPECT_EQ(this->take(other.next()), Kind::kNew);
  EXPECT_TRUE(this->last_.begins);
  EXPECT_EQ(this->last_.missing, 0u);
  EXPECT_EQ(this->receiver_.header().epoch, 8u);
  EXPECT_EQ(this->receiver_.generation(), 2u);
  EXPECT_EQ(this->take(this->sender_.next()), Kind::kRefused) << "now it is the other's";
  EXPECT_EQ(this->receiver_.counters().refused, 2u);
}

TYPED_TEST(StreamReceiverTest, AnotherSampleRateIsAnotherCountOfSamples) {
  this->take(this->sender_.next());
  TypeParam slower = this->sender_.next();
  slower.ticks_per_sample = 2;
  slower.sample_period_ns = 2'000'000;
  EXPECT_EQ(this->take(slower), Kind::kNew);
  EXPECT_TRUE(this->last_.begins);
  EXPECT_EQ(this->last_.first, kBlock / 2);
  EXPECT_EQ(this->receiver_.generation(), 2u);
}

TYPED_TEST(StreamReceiverTest, WhatCannotBeIsRefusedAndChangesNothing) {
  this->take(this->sender_.next());
  TypeParam bad = this->sender_.next();
  const TypeParam good = bad;
  bad.sample_period_ns = 0;
  EXPECT_EQ(this->take(bad), Kind::kRefused);
  bad = good;
  bad.ticks_per_sample = 0;
  EXPECT_EQ(this->take(bad), Kind::kRefused);
  bad = good;
  bad.first_tick += 60'000;
  EXPECT_EQ(this->take(bad), Kind::kRefused) << "a minute ahead of what the time allows";
  bad = good;
  bad.payload.size = 3;
  EXPECT_EQ(this->take(bad), Kind::kRefused);
  EXPECT_EQ(this->receiver_.receive({good, this->now_ns_}, kAlways, 5).kind, Kind::kRefused);
  EXPECT_EQ(this->receiver_.receive({good, this->now_ns_}, kAlways, 4).kind, Kind::kNew);
  EXPECT_EQ(this->receiver_.counters().refused, 5u);
  EXPECT_EQ(this->receiver_.counters().lost, 0u);
}

TEST(CommandStreamReceiver, AnotherScaleOrLawIsAnotherGenerationAndNotComparableWithWhatComesLate) {
  StreamReceiver<CommandBlock> receiver(0.15);
  Sender<CommandBlock> sender(7);
  std::int64_t now_ns = 0;
  const auto take = [&](const CommandBlock& block) {
    return receiver.receive({block, now_ns += kBlock * kMs}, kAlways).kind;
  };
  take(sender.next());
  const CommandBlock late = sender.next();
  CommandBlock rescaled = sender.next();
  rescaled.beta = 0.5;
  EXPECT_EQ(take(rescaled), Kind::kNew);
  EXPECT_EQ(receiver.generation(), 2u);
  EXPECT_EQ(take(late), Kind::kStale);
  CommandBlock other_law = sender.next();
  other_law.beta = 0.5;
  other_law.law = Law::kAnchored;
  EXPECT_EQ(take(other_law), Kind::kNew);
  EXPECT_EQ(receiver.generation(), 3u);
}

}  // namespace
}  // namespace telekerf::streaming
