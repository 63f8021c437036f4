// SPDX-License-Identifier: Apache-2.0
// What no true sender says is refused, and the true one goes on being heard.
#include <vector>

#include "tests/unit/streaming/stream_receiver_fixture.h"

namespace telekerf::streaming {
namespace {

template <class Block>
class StreamBounds : public StreamReceiverTest<Block> {};

TYPED_TEST_SUITE(StreamBounds, Blocks);

/// A forged number must not silence the true sender: it may be ahead by the time that has passed and 64
/// blocks.
TYPED_TEST(StreamBounds, ANumberFarAheadIsRefusedAndTheStreamGoesOn) {
  ASSERT_EQ(this->take(this->sender_.next()), Kind::kNew);
  TypeParam forged = this->sender_.next();
  const TypeParam good = forged;
  this->now_ns_ -= kBlock * kMs;
  for (const std::uint32_t ahead : {0x7FFFFFFEU, 0x10000U, 66U}) {
    forged.sequence = good.sequence + ahead;
    EXPECT_EQ(this->take(forged), Kind::kRefused) << ahead;
    this->now_ns_ -= kBlock * kMs;
  }
  EXPECT_EQ(this->take(good), Kind::kNew);
  EXPECT_EQ(this->receiver_.counters().lost, 0u);
  TypeParam jumped = this->sender_.next();
  jumped.sequence += 64;
  EXPECT_EQ(this->take(jumped), Kind::kNew) << "delay that became less";
  for (int n = 0; n < 64; ++n) (void)this->take(this->sender_.next());
  EXPECT_EQ(this->take(this->sender_.next()), Kind::kNew)
      << "the true sender has caught up, or its lease has begun";
}

TYPED_TEST(StreamBounds, ASenderWhoseCountBeganAnewIsTakenAfterASecond) {
  for (int n = 0; n < 100; ++n) ASSERT_EQ(this->take(this->sender_.next()), Kind::kNew);
  Sender<TypeParam> again(7);
  this->now_ns_ += 984 * kMs - kBlock * kMs;
  EXPECT_EQ(this->take(again.next()), Kind::kStale);
  this->now_ns_ += kBlock * kMs;
  EXPECT_EQ(this->take(again.next()), Kind::kNew);
  EXPECT_TRUE(this->last_.begins);
}

TYPED_TEST(StreamBounds, ASenderWhoseCountBeganAnewIsStaleForASecondToTheNanosecond) {
  Sender<TypeParam> again(7);
  (void)this->sender_.next();
  ASSERT_EQ(this->receiver_.receive({this->sender_.next(), 0}, kAlways).kind, Kind::kNew);
  ASSERT_EQ(this->receiver_.silent_s(1000 * kMs), 1.0);
  EXPECT_EQ(this->receiver_.receive({again.next(), 1000 * kMs}, kAlways).kind, Kind::kStale);
  const Arrival taken = this->receiver_.receive({again.next(), 1000 * kMs + 1}, kAlways);
  EXPECT_EQ(taken.kind, Kind::kNew);
  EXPECT_TRUE(taken.begins);
}

/// A tape of five seconds ago, played during an outage: the true sender is heard again a second after its
/// end.
TYPED_TEST(StreamBounds, WhoFollowsATapeIsHeardAgainAfterASecond) {
  std::vector<TypeParam> tape;
  for (int n = 0; n < 400; ++n) {
    tape.push_back(this->sender_.next());
    ASSERT_EQ(this->take(tape.back()), Kind::kNew);
  }
  this->now_ns_ += 1100 * kMs;
  for (int n = 0; n < 60; ++n) (void)this->take(tape[static_cast<std::size_t>(n)]);
  const std::uint64_t taken = this->receiver_.counters().blocks;
  int deaf = 0;
  for (int n = 0; n < 129; ++n) (void)this->sender_.next();  // sent meanwhile
  while (this->take(this->sender_.next()) != Kind::kNew && deaf < 1000) ++deaf;
  EXPECT_GT(taken, 400U) << "nobody can tell the tape from a sender that began anew";
  EXPECT_NEAR(deaf, 62, 3) << "blocks";
  for (int n = 0; n < 10; ++n) EXPECT_EQ(this->take(this->sender_.next()), Kind::kNew);
}

TYPED_TEST(StreamBounds, WhatNoArithmeticBearsIsRefused) {
  const auto refused = [&](auto change) {
    StreamReceiver<TypeParam> receiver(0.15);
    Sender<TypeParam> sender(7);
    TypeParam block = sender.next();
    change(block);
    return receiver.receive({block, 0}, kAlways).kind == Kind::kRefused;
  };
  EXPECT_FALSE(refused([](auto&) {}));
  EXPECT_TRUE(refused([](auto& block) { block.first_tick = ~Tick{0}; }));
  // A thousand million seconds of a millisecond each.
  EXPECT_TRUE(refused([](auto& block) { block.first_tick = Tick{1'000'000'000'016}; }));
  EXPECT_FALSE(refused([](auto& block) { block.first_tick = Tick{999'999'999'984}; }));
  for (const std::uint32_t period_ns : {0U, 9'999U, 100'000'001U, 0xFFFFFFFFU})
    EXPECT_TRUE(refused([&](auto& block) { block.sample_period_ns = period_ns; })) << period_ns;
  for (const std::uint32_t period_ns : {10'000U, 100'000'000U})
    EXPECT_FALSE(refused([&](auto& block) { block.sample_period_ns = period_ns; })) << period_ns;
  for (const int ticks : {0, 1001, 65535})
    EXPECT_TRUE(refused([&](auto& block) { block.ticks_per_sample = static_cast<std::uint16_t>(ticks); }))
        << ticks;
  EXPECT_FALSE(refused([](auto& block) { block.ticks_per_sample = 1000; }));
  EXPECT_FALSE(refused([](auto& block) {
    block.ticks_per_sample = 1000;
    block.first_tick = Tick{999'999'999'984'000};
  })) << "as many samples";
  EXPECT_TRUE(refused([](auto& block) {
    block.ticks_per_sample = 1000;
    block.first_tick = Tick{1'000'000'000'016'000};
  }));
}

}  // namespace
}  // namespace telekerf::streaming
