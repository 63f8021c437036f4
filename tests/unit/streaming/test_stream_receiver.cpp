// SPDX-License-Identifier: Apache-2.0
// Order and epoch, judged in one place for both streams: what is new, late, lost, repeated or refused.
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "common/codec/settings.h"
#include "common/streaming/packet_samples.h"
#include "tests/unit/streaming/stream_receiver_fixture.h"

namespace telekerf::streaming {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

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

/// A side that has been started anew may hear a recording first.
TYPED_TEST(StreamReceiverTest, TheFirstThatAnswersIsListenedToAtOnceAndLaterOnesAreNot) {
  const auto answering = [this](const TypeParam& block) {
    this->last_ = this->receiver_.receive({block, this->now_ns_}, kAlways, {}, true);
    this->now_ns_ += kBlock * kMs;
    return this->last_.kind;
  };
  const TypeParam recorded = this->sender_.next();
  for (int n = 0; n < 400; ++n) (void)this->sender_.next();
  EXPECT_EQ(this->take(recorded), Kind::kNew);
  EXPECT_EQ(this->take(this->sender_.next()), Kind::kRefused) << "too far ahead of the recording";
  EXPECT_EQ(answering(this->sender_.next()), Kind::kNew);
  EXPECT_TRUE(this->last_.begins);
  EXPECT_EQ(this->last_.missing, 0u);
  EXPECT_EQ(answering(this->sender_.next()), Kind::kNew);
  EXPECT_FALSE(this->last_.begins);
  EXPECT_EQ(answering(recorded), Kind::kStale);
  for (int n = 0; n < 400; ++n) (void)this->sender_.next();
  EXPECT_EQ(answering(this->sender_.next()), Kind::kRefused) << "too far ahead, whoever says it";
}

TYPED_TEST(StreamReceiverTest, WhoAnswersNeedNotWaitForTheSilenceOfWhoDoesNot) {
  Sender<TypeParam> recording(8);
  this->take(recording.next());
  EXPECT_EQ(this->take(this->sender_.next()), Kind::kRefused);
  this->last_ = this->receiver_.receive({this->sender_.next(), this->now_ns_}, kAlways, {}, true);
  EXPECT_EQ(this->last_.kind, Kind::kNew);
  EXPECT_EQ(this->receiver_.header().epoch, 7u);
  this->last_ = this->receiver_.receive({recording.next(), this->now_ns_}, kAlways, {}, true);
  EXPECT_EQ(this->last_.kind, Kind::kRefused) << "one that answers too, but later";
  // Where that one has fallen silent, it is as at the start.
  this->now_ns_ += 200 * kMs;
  EXPECT_EQ(this->take(recording.next()), Kind::kNew);
  this->last_ = this->receiver_.receive({this->sender_.next(), this->now_ns_}, kAlways, {}, true);
  EXPECT_EQ(this->last_.kind, Kind::kNew);
}

TYPED_TEST(StreamReceiverTest, AnotherSenderKnocksInVainUntilOursIsSilent) {
  Sender<TypeParam> other(8);
  this->take(this->sender_.next());
  EXPECT_FALSE(this->receiver_.contested(this->now_ns_));
  EXPECT_EQ(this->take(other.next()), Kind::kRefused);
  EXPECT_TRUE(this->receiver_.contested(this->now_ns_ + 133 * kMs)) << "150 ms after it came";
  EXPECT_FALSE(this->receiver_.contested(this->now_ns_ + 135 * kMs));
  EXPECT_EQ(this->take(this->sender_.next()), Kind::kNew);
  EXPECT_TRUE(this->receiver_.contested(this->now_ns_)) << "by both";
  this->now_ns_ += 200 * kMs;
  EXPECT_EQ(this->take(other.next()), Kind::kNew);
  EXPECT_TRUE(this->last_.begins);
  EXPECT_EQ(this->last_.missing, 0u);
  EXPECT_EQ(this->receiver_.header().epoch, 8u);
  EXPECT_FALSE(this->receiver_.contested(this->now_ns_));
  EXPECT_EQ(this->receiver_.generation(), 2u);
  EXPECT_EQ(this->take(this->sender_.next()), Kind::kRefused) << "now it is the other's";
  EXPECT_EQ(this->receiver_.counters().refused, 2u);
}

TYPED_TEST(StreamReceiverTest, SilenceIsMeasuredFromTheNewestBlockThatWasTaken) {
  auto& receiver = this->receiver_;
  const auto at = [&](std::int64_t now_ns, const TypeParam& block) {
    return receiver.receive({block, now_ns}, kAlways).kind;
  };
  const TypeParam overtaken = this->sender_.next();
  const TypeParam first = this->sender_.next();
  const TypeParam third = (this->sender_.next(), this->sender_.next());
  EXPECT_EQ(at(1000 * kMs, first), Kind::kNew);
  EXPECT_EQ(at(1016 * kMs, third), Kind::kNew);
  EXPECT_EQ(receiver.arrived_ns(), 1016 * kMs);
  EXPECT_EQ(at(1100 * kMs, third), Kind::kStale);
  EXPECT_EQ(at(1100 * kMs, overtaken), Kind::kStale);
  EXPECT_EQ(receiver.arrived_ns(), 1016 * kMs) << "what is repeated breaks no silence";
  EXPECT_NEAR(receiver.silent_s(1100 * kMs), 0.084, 1e-12);
  Sender<TypeParam> other(8);
  EXPECT_EQ(at(1165 * kMs, other.next()), Kind::kRefused);
  EXPECT_EQ(at(1166 * kMs - 1, other.next()), Kind::kRefused);
  EXPECT_EQ(receiver.arrived_ns(), 1016 * kMs) << "nor does another sender";
  EXPECT_EQ(at(1166 * kMs + 1, other.next()), Kind::kNew);
}

TYPED_TEST(StreamReceiverTest, ASilenceOfItsVeryLengthIsNotLongEnough) {
  StreamReceiver<TypeParam> receiver(0.25);
  Sender<TypeParam> other(8);
  ASSERT_EQ(receiver.receive({this->sender_.next(), 0}, kAlways).kind, Kind::kNew);
  ASSERT_EQ(receiver.silent_s(250 * kMs), 0.25);
  EXPECT_EQ(receiver.receive({other.next(), 250 * kMs}, kAlways).kind, Kind::kRefused);
  EXPECT_EQ(receiver.receive({other.next(), 250 * kMs + 1}, kAlways).kind, Kind::kNew);
}

// The decoder remembers 64 numbers; that the first block has come needs no memory.
TYPED_TEST(StreamReceiverTest, TheFirstBlockIsNeverLostHoweverLateItComesAgain) {
  const TypeParam first = this->sender_.next();
  this->take(first);
  const TypeParam second = this->sender_.next();
  this->take(this->sender_.next());
  EXPECT_EQ(this->take(second), Kind::kLate) << "the one after it may have been";
  for (int n = 0; n < 100; ++n) this->take(this->sender_.next());
  EXPECT_EQ(this->take(first), Kind::kStale);
  EXPECT_EQ(this->receiver_.counters().lost, 0u);
  EXPECT_EQ(this->receiver_.counters().blocks, 103u);
}

TYPED_TEST(StreamReceiverTest, AnotherSenderBeginsEverythingAnew) {
  for (int n = 0; n < 100; ++n) this->take(this->sender_.next());
  this->now_ns_ += 200 * kMs;
  Sender<TypeParam> other(8, 40);  // numbers that were had before, of the blocks and within them
  TypeParam broken = other.next();
  broken.payload.size = 3;
  EXPECT_EQ(this->take(broken), Kind::kRefused);
  EXPECT_FALSE(this->receiver_.heard()) << "whoever comes next may be the one";
  const TypeParam begin = other.next();
  EXPECT_EQ(this->take(begin), Kind::kNew);
  EXPECT_TRUE(this->last_.begins);
  EXPECT_EQ(this->last_.missing, 0u);
  EXPECT_EQ(this->take(broken), Kind::kStale);
  TypeParam ahead = other.next();
  ahead.first_tick += 1100;
  EXPECT_EQ(this->take(ahead), Kind::kRefused) << "ahead of its own samples, not of the other's";
  EXPECT_EQ(this->receiver_.counters().lost, 0u);
}

TYPED_TEST(StreamReceiverTest, AStampMayBeASecondAheadOfWhatTheTimeAllows) {
  for (const std::uint32_t period_ms : {1U, 2U}) {
    for (const std::int64_t wait_ms : {16, 400}) {
      StreamReceiver<TypeParam> receiver(0.15);
      Sender<TypeParam> sender(7);
      const auto next = [&] {
        TypeParam block = sender.next();
        block.sample_period_ns = period_ms * 1'000'000;
        return block;
      };
      EXPECT_EQ(receiver.receive({next(), 0}, kAlways).kind, Kind::kNew);
      const std::int64_t allowed = (1000 + wait_ms) / period_ms;  // newest one 15, first of the next 16
      TypeParam block = next();
      block.first_tick += static_cast<Tick>(allowed);
      EXPECT_EQ(receiver.receive({block, wait_ms * kMs - 1}, kAlways).kind, Kind::kRefused) << period_ms;
      block.first_tick -= 1;
      EXPECT_EQ(receiver.receive({block, wait_ms * kMs + 1}, kAlways).kind, Kind::kNew) << period_ms;
    }
  }
}

TYPED_TEST(StreamReceiverTest, AStampOfJustASecondAheadIsTaken) {
  ASSERT_EQ(this->receiver_.receive({this->sender_.next(), 0}, kAlways).kind, Kind::kNew);
  TypeParam block = this->sender_.next();
  block.first_tick = static_cast<Tick>(this->receiver_.newest() + 1001);
  EXPECT_EQ(this->receiver_.receive({block, 0}, kAlways).kind, Kind::kRefused);
  block.first_tick -= 1;
  ASSERT_EQ(1000 * (1e-9 * block.sample_period_ns), 1.0);
  EXPECT_EQ(this->receiver_.receive({block, 0}, kAlways).kind, Kind::kNew);
}

TYPED_TEST(StreamReceiverTest, AFirstBlockOfOneSampleIsCountedAsOne) {
  codec::StreamSettings settings = codec::with_codec({}, "batched");
  settings.block = 1;
  settings.redundancy = 0;
  codec::BlockEncoder encoder(settings);
  const auto block_at = [&](std::uint32_t number, Tick tick) {
    TypeParam block;
    block.sequence = number;
    block.sample_period_ns = 1'000'000;
    block.ticks_per_sample = 1;
    block.first_tick = tick;
    const std::vector<Vec3> one(1, Vec3(1e-3, 0, 0));
    block.payload.size =
        static_cast<std::uint16_t>(encoder.encode(one, 0, {}, block.payload.room()).value_or(0));
    return block;
  };
  auto& receiver = this->receiver_;
  ASSERT_EQ(receiver.receive({block_at(1, 0), 0}, kAlways).kind, Kind::kNew);
  EXPECT_EQ(receiver.receive({block_at(2, 1017), 16 * kMs + kMs / 2}, kAlways).kind, Kind::kRefused);
  EXPECT_EQ(receiver.receive({block_at(3, 1016), 16 * kMs + kMs / 2}, kAlways).kind, Kind::kNew);
}

TYPED_TEST(StreamReceiverTest, TheNewestSampleIsTheFurthestOneThatCame) {
  this->take(this->sender_.next());
  TypeParam far = this->sender_.next();
  far.first_tick += 900;
  EXPECT_EQ(this->take(far), Kind::kNew);
  EXPECT_EQ(this->take(this->sender_.next()), Kind::kNew) << "back where it was";
  TypeParam farther = this->sender_.next();
  farther.first_tick += 1800;
  EXPECT_EQ(this->take(farther), Kind::kNew);
}

TYPED_TEST(StreamReceiverTest, AnOvertakenBlockIsOfUseWhileItsLastSampleMayBeAndItsKindIsTheNewests) {
  const auto overtaken = [&](std::int64_t useful_from, auto change) {
    StreamReceiver<TypeParam> receiver(0.15);
    Sender<TypeParam> sender(7);
    receiver.receive({sender.next(), 0}, kAlways);
    TypeParam late = sender.next();
    receiver.receive({sender.next(), 2 * kBlock * kMs}, kAlways);
    change(late);
    const Arrival arrival = receiver.receive({late, 3 * kBlock * kMs}, useful_from);
    const bool used = arrival.kind == Kind::kLate;
    EXPECT_EQ(used, arrival.packet != nullptr);
    EXPECT_EQ(receiver.counters().blocks, used ? 3u : 2u);
    EXPECT_EQ(receiver.counters().stale, used ? 0u : 1u);
    EXPECT_EQ(receiver.counters().lost, used ? 0u : 1u);
    return used;
  };
  const auto as_it_is = [](TypeParam&) {};
  EXPECT_TRUE(overtaken(kBlock + 63, as_it_is)) << "the longest block has 64 samples";
  EXPECT_FALSE(overtaken(kBlock + 64, as_it_is));
  EXPECT_FALSE(overtaken(kAlways, [](TypeParam& late) { late.sample_period_ns = 2'000'000; }));
  EXPECT_FALSE(overtaken(kAlways, [](TypeParam& late) { late.ticks_per_sample = 2; }));
  EXPECT_FALSE(overtaken(kAlways, [](TypeParam& late) { late.payload.size = 3; }));
}

/// Positions come as what is left of the straight line through the anchor.
TYPED_TEST(StreamReceiverTest, PositionsAreDecodedAboutTheAnchorsLine) {
  codec::BlockEncoder encoder({.max_rms = 1e-7, .redundancy = 0, .sample_period_ns = 2'000'000});
  TypeParam block = this->sender_.next();
  block.sample_period_ns = 2'000'000;
  block.anchor = {Vec3(3e-3, -2e-3, 1e-3), Vec3(0.05, -0.03, 0.01)};
  std::vector<Vec3> samples;
  for (int n = 0; n < kBlock; ++n)
    samples.push_back(block.anchor.position_m + 2e-3 * n * block.anchor.velocity_m_per_s);
  const codec::Trend trend{block.anchor.position_m, 2e-3 * block.anchor.velocity_m_per_s};
  block.payload.size =
      static_cast<std::uint16_t>(encoder.encode(samples, 0, trend, block.payload.room()).value_or(0));
  ASSERT_EQ(this->take(block), Kind::kNew);
  for (std::size_t n = 0; n < kBlock; ++n) {
    EXPECT_LT((this->last_.packet->blocks_newest_first[0].samples[n] - samples[n]).norm(), 1e-6) << n;
  }
}

TEST(CommandStreamReceiver, AccelerationsHaveNoLineThroughThem) {
  for (const Law law : {Law::kAnchored, Law::kRemoteAcceleration}) {
    StreamReceiver<CommandBlock> receiver(0.15);
    Sender<CommandBlock> sender(7);
    CommandBlock block = sender.next();
    block.law = law;
    block.anchor = {Vec3(3e-3, -2e-3, 1e-3), Vec3(0.05, -0.03, 0.01)};
    const Arrival arrival = receiver.receive({block, 0}, kAlways);
    ASSERT_EQ(arrival.kind, Kind::kNew);
    for (std::size_t n = 0; n < kBlock; ++n) {
      EXPECT_LT(
          (arrival.packet->blocks_newest_first[0].samples[n] - place(static_cast<std::int64_t>(n))).norm(),
          1e-6);
    }
  }
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
  (void)this->sender_.next();
  TypeParam longer = this->sender_.next();
  longer.ticks_per_sample = 2;  // as far apart as at first, of ticks that are shorter
  EXPECT_EQ(this->take(longer), Kind::kNew);
  EXPECT_TRUE(this->last_.begins);
  EXPECT_EQ(this->last_.missing, 1u) << "a block is missing between them all the same";
  EXPECT_EQ(this->receiver_.counters().lost, 1u);
  EXPECT_EQ(this->receiver_.generation(), 3u);
}

TYPED_TEST(StreamReceiverTest, WhatCannotBeIsRefusedAndChangesNothing) {
  this->take(this->sender_.next());
  TypeParam bad = this->sender_.next();
  const TypeParam good = bad;
  bad.sample_period_ns = 0;
  EXPECT_EQ(this->take(bad), Kind::kRefused);
  EXPECT_EQ(this->last_.first, 0);
  EXPECT_EQ(this->last_.missing, 0u);
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
  CommandBlock late_too = sender.next();
  late_too.beta = 0.5;
  late_too.law = Law::kAnchored;
  CommandBlock same = sender.next();
  same.beta = 0.5;
  EXPECT_EQ(take(same), Kind::kNew);
  EXPECT_EQ(receiver.generation(), 2u);
  EXPECT_EQ(take(late_too), Kind::kStale) << "of another law";
  CommandBlock other_law = sender.next();
  other_law.beta = 0.5;
  other_law.law = Law::kAnchored;
  EXPECT_EQ(take(other_law), Kind::kNew);
  EXPECT_EQ(receiver.generation(), 3u);
}

}  // namespace
}  // namespace telekerf::streaming
