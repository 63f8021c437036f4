// SPDX-License-Identifier: Apache-2.0
// The sending end: full blocks, numbered, anchored, decodable; settings change where blocks begin.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/codec/decoder.h"
#include "common/streaming/packetizer.h"
#include "tests/unit/streaming/blocks.h"

namespace telekerf::streaming {
namespace {

class PacketizerTest : public testing::Test {
 protected:
  /// Samples until a block is full; false: it could not be coded.
  bool fill(const Vec3& instead = Vec3::Zero(), int at = -1) {
    lengths_ = 0;
    if (packets_.at_beginning()) packets_.begin(index_, {place(index_), Vec3(1e-2, 0.0, 0.0)});
    for (bool full = false; !full; ++index_, ++lengths_) {
      full = packets_.add(lengths_ == at ? instead : place(index_), lengths_ % 2 == 1);
    }
    block_ = {};
    return packets_.pack(77'123, block_);
  }

  codec::Trend trend() const {
    return {block_.anchor.position_m, block_.anchor.velocity_m_per_s * (block_.sample_period_ns * 1e-9)};
  }

  Packetizer packets_{{.codec = {.max_rms = 1e-7, .redundancy = 1},
                       .ticks_per_sample = 2,
                       .sample_period_ns = 1'000'000,
                       .epoch = 9}};
  codec::BlockDecoder decoder_;
  StateBlock block_;
  std::int64_t index_ = 0;
  int lengths_ = 0;
};

TEST_F(PacketizerTest, BeforeItsFirstBlockItIsAtTheStreamsBeginning) {
  EXPECT_TRUE(packets_.at_beginning());
  EXPECT_EQ(packets_.index(), 0);
  EXPECT_EQ(packets_.buttons(), 0u);
}

TEST_F(PacketizerTest, ABlockSaysItsPlaceInTheStreamAndDecodesToItsSamples) {
  for (std::uint32_t n = 1; n <= 5; ++n) {
    const std::int64_t first = index_;
    ASSERT_TRUE(fill());
    EXPECT_EQ(block_.sequence, n);
    EXPECT_EQ(block_.epoch, 9u);
    EXPECT_EQ(block_.first_tick, static_cast<Tick>(2 * first));
    EXPECT_EQ(block_.ticks_per_sample, 2);
    EXPECT_EQ(block_.sent_ns, 77'000) << "in whole microseconds";
    EXPECT_EQ(block_.anchor.position_m, place(first));
    EXPECT_EQ(packets_.buttons(), 0xAAAAu);
    const auto packet = decoder_.decode(block_.payload.view(), trend());
    ASSERT_TRUE(packet);
    EXPECT_EQ((*packet)->blocks, n == 1 ? 1 : 2);
    const auto& newest = (*packet)->blocks_newest_first[0];
    EXPECT_EQ(newest.button, 0xAAAAu);
    for (int i = 0; i < kBlock; ++i) {
      const auto at = static_cast<std::size_t>(i);
      EXPECT_LT((newest.samples[at] - place(first + i)).norm(), 1e-6);
      EXPECT_EQ(newest.samples[at], packets_.decoded()[at]) << "the sender knows what is received";
    }
  }
}

TEST_F(PacketizerTest, CopiesMayChangeFromPacketToPacket) {
  for (const int copies : {1, 1, 3, 3, 0}) {
    packets_.repeat(copies);
    const auto before = static_cast<int>(block_.sequence);
    ASSERT_TRUE(fill());
    EXPECT_EQ(packets_.copies(), std::min(copies, before));
    EXPECT_EQ(packets_.block(), kBlock);
  }
}

TEST_F(PacketizerTest, OtherSettingsApplyFromTheNextBlock) {
  ASSERT_TRUE(fill());
  packets_.begin(index_, {});
  packets_.add(place(index_++), false);
  packets_.change({.block = 32, .max_rms = 1e-7, .sample_period_ns = 2'000'000, .anchored = false});
  ASSERT_TRUE(fill());
  EXPECT_EQ(lengths_ + 1, kBlock) << "the one that was begun stays as long as it was";
  const std::int64_t first = index_;
  ASSERT_TRUE(fill());
  EXPECT_EQ(lengths_, 32);
  const auto packet = decoder_.decode(block_.payload.view(), trend());
  ASSERT_TRUE(packet);
  EXPECT_EQ((*packet)->head.sample_period_ns, 1'000'000u) << "the rate stays";
  EXPECT_TRUE((*packet)->head.anchored);
  for (std::size_t i = 0; i < 32; ++i) {
    EXPECT_LT(
        ((*packet)->blocks_newest_first[0].samples[i] - place(first + static_cast<std::int64_t>(i))).norm(),
        1e-6)
        << "and the anchor's line";
  }
  ASSERT_TRUE(fill());
  const auto next = decoder_.decode(block_.payload.view(), trend());
  ASSERT_TRUE(next);
  EXPECT_EQ((*next)->blocks, 2) << "changed once, not at every block";
  EXPECT_EQ(PacketizerSettings{}.ticks_per_sample, 1);
  EXPECT_EQ(PacketizerSettings{}.sample_period_ns, 1'000'000u);
  EXPECT_EQ(PacketizerSettings{}.epoch, 1u);
}

TEST_F(PacketizerTest, AnotherOneGoesOnWithItsNumbers) {
  ASSERT_TRUE(fill());
  ASSERT_TRUE(fill());
  const std::uint32_t number = block_.sequence;
  Packetizer next({.codec = {.block = 8, .sample_period_ns = 1'000'000, .anchored = false},
                   .ticks_per_sample = 1,
                   .sample_period_ns = 1'000'000,
                   .epoch = 1});
  next.take_over(packets_);
  next.begin(index_, {});
  for (int n = 0; n < 8; ++n) (void)next.add(place(index_++), false);
  ASSERT_TRUE(next.pack(0, block_));
  EXPECT_EQ(block_.sequence, number + 1);
  const auto packet = decoder_.decode(block_.payload.view(), {});
  ASSERT_TRUE(packet) << "the decoder of before takes it";
  EXPECT_FALSE((*packet)->head.anchored);
  EXPECT_EQ((*packet)->blocks, 1) << "stands alone";
}

TEST_F(PacketizerTest, ABlockThatCannotBeCodedCostsItsNumberAndNothingElse) {
  ASSERT_TRUE(fill());
  EXPECT_FALSE(fill(Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), 3));
  const std::int64_t first = index_;
  ASSERT_TRUE(fill());
  EXPECT_EQ(block_.sequence, 3u);
  EXPECT_EQ(block_.first_tick, static_cast<Tick>(2 * first));
  const auto packet = decoder_.decode(block_.payload.view(), trend());
  ASSERT_TRUE(packet);
  EXPECT_EQ((*packet)->blocks, 1) << "stands alone";
}

TEST_F(PacketizerTest, SettingsOutOfBoundsAreRefused) {
  EXPECT_ANY_THROW(packets_.change({.block = 65}));
  ASSERT_TRUE(fill());
  EXPECT_EQ(lengths_, kBlock);
}

}  // namespace
}  // namespace telekerf::streaming
