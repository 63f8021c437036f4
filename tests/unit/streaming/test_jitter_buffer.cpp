// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "common/streaming/jitter_buffer.h"

namespace telekerf::streaming {
namespace {

TEST(JitterBuffer, HoldsTheNewestAndForgetsWhatWasOverwritten) {
  JitterBuffer ring;
  StreamSample sample;
  for (std::int64_t i = 0; i < 3 * static_cast<std::int64_t>(JitterBuffer::kSize); ++i) {
    sample.value.x() = static_cast<double>(i);
    ring.store(i, sample);
  }
  const std::int64_t end = 3 * static_cast<std::int64_t>(JitterBuffer::kSize);
  EXPECT_EQ(ring.find(end), nullptr);
  EXPECT_EQ(ring.find(-1), nullptr);
  EXPECT_EQ(ring.find(5), nullptr);
  ASSERT_NE(ring.find(end - 1), nullptr);
  EXPECT_EQ(ring.find(end - 1)->value.x(), static_cast<double>(end - 1));
}

TEST(JitterBuffer, IsEmptyAfterItWasClearedAndTakesNothingFromBeforeTheBeginning) {
  JitterBuffer ring;
  ring.store(0, {});
  ring.store(-5, {});
  EXPECT_NE(ring.find(0), nullptr);
  EXPECT_EQ(ring.find(static_cast<std::int64_t>(JitterBuffer::kSize) - 5), nullptr);
  ring.clear();
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(JitterBuffer::kSize); ++i)
    EXPECT_EQ(ring.find(i), nullptr);
}

/// A packet of a block and its seven copies, made by hand: sample values and buttons tell their index.
class PacketInBuffer : public testing::Test {
 protected:
  static constexpr std::int64_t kFirst = 80;
  static constexpr int kSize = 10;
  static constexpr int kBlocks = 8;

  PacketInBuffer() {
    packet_.blocks = kBlocks;
    packet_.block_size = kSize;
    samples_.resize(kBlocks);
    for (int age = 0; age < kBlocks; ++age) {
      auto& block = packet_.blocks_newest_first[static_cast<std::size_t>(age)];
      auto& samples = samples_[static_cast<std::size_t>(age)];
      for (int n = 0; n < kSize; ++n) {
        const std::int64_t index = kFirst - kSize * age + n;
        samples.push_back(value(index));
        if (index % 3 == 0) block.button |= std::uint64_t{1} << n;
      }
      block.samples = samples;
    }
    header_.sequence = 100;
    header_.first_tick = kFirst;
    header_.sample_period_ns = 2'000'000;
    header_.engaged = true;
    header_.anchor = {Vec3(1e-3, 2e-3, 3e-3), Vec3(0.01, 0.02, 0.03)};
  }
  static Vec3 value(std::int64_t index) { return {0.1 * static_cast<double>(index % 7), -0.3, 0.0}; }
  void store() { ring_.store(PacketSamples(packet_, kFirst), header_, 5); }

  codec::DecodedPacket packet_;
  std::vector<std::vector<Vec3>> samples_;
  CommandHeader header_;
  JitterBuffer ring_;
};

TEST_F(PacketInBuffer, EverySampleIsAtItsPlaceWithWhatItsOwnBlockSaid) {
  packet_.blocks = 8;
  header_.engaged_before = 0b1100101;
  store();
  EXPECT_EQ(ring_.find(kFirst + kSize), nullptr);
  EXPECT_EQ(ring_.find(kFirst - 7 * kSize - 1), nullptr);
  for (std::int64_t index = kFirst - 7 * kSize; index < kFirst + kSize; ++index) {
    const StreamSample* sample = ring_.find(index);
    ASSERT_NE(sample, nullptr) << index;
    const auto age = (kFirst + kSize - 1 - index) / kSize;
    EXPECT_EQ(sample->value, value(index));
    EXPECT_EQ(sample->acceleration_m_per_s2, Vec3(Vec3::Zero()));
    EXPECT_EQ(sample->button, index % 3 == 0) << index;
    EXPECT_EQ(sample->block, 100u - static_cast<std::uint32_t>(age)) << index;
    EXPECT_EQ(sample->engaged, age == 0 || age == 1 || age == 3 || age >= 6) << index;
    EXPECT_EQ(sample->generation, 5u);
    EXPECT_FALSE(sample->concealed);
  }
}

TEST_F(PacketInBuffer, ADisengagedBlocksCopiesMayBeEngaged) {
  packet_.blocks = 2;
  header_.engaged = false;
  header_.engaged_before = 1;
  store();
  EXPECT_FALSE(ring_.find(kFirst)->engaged);
  EXPECT_TRUE(ring_.find(kFirst - 1)->engaged);
}

TEST_F(PacketInBuffer, AccelerationsAreIntegratedFromTheAnchorBothWays) {
  packet_.blocks = 3;
  header_.law = Law::kAnchored;
  store();
  KinematicState state{header_.anchor.position_m, header_.anchor.velocity_m_per_s, Vec3::Zero()};
  for (std::int64_t index = kFirst; index < kFirst + kSize; ++index) {
    const StreamSample* sample = ring_.find(index);
    EXPECT_EQ(sample->value, state.position_m) << index << ": bit for bit";
    EXPECT_EQ(sample->velocity_m_per_s, state.velocity_m_per_s) << index;
    EXPECT_EQ(sample->acceleration_m_per_s2, value(index));
    state.acceleration_m_per_s2 = value(index);
    state = control::advanced(state, 2e-3);
  }
  for (std::int64_t index = kFirst - 2 * kSize; index < kFirst; ++index) {
    const StreamSample* now = ring_.find(index);
    const StreamSample* next = ring_.find(index + 1);
    EXPECT_EQ(now->acceleration_m_per_s2, value(index));
    const KinematicState led = control::advanced({now->value, now->velocity_m_per_s, value(index)}, 2e-3);
    EXPECT_LT((led.position_m - next->value).norm(), 1e-15) << index;
    EXPECT_LT((led.velocity_m_per_s - next->velocity_m_per_s).norm(), 1e-15) << index;
  }
}

TEST_F(PacketInBuffer, BareAccelerationsHaveNoState) {
  packet_.blocks = 2;
  header_.law = Law::kRemoteAcceleration;
  store();
  for (const std::int64_t index : {kFirst - 1, kFirst}) {
    EXPECT_EQ(ring_.find(index)->value, Vec3(Vec3::Zero()));
    EXPECT_EQ(ring_.find(index)->velocity_m_per_s, Vec3(Vec3::Zero()));
    EXPECT_EQ(ring_.find(index)->acceleration_m_per_s2, value(index));
  }
}

TEST_F(PacketInBuffer, WhatIsKnownStaysAndWhatWasConcealedGivesWay) {
  packet_.blocks = 2;
  StreamSample known;
  known.value = Vec3(9, 9, 9);
  StreamSample concealed = known;
  concealed.concealed = true;
  for (const std::int64_t index : {kFirst - 2, kFirst + 2}) {
    ring_.store(index, known);
    ring_.store(index + 1, concealed);
  }
  store();
  for (const std::int64_t index : {kFirst - 2, kFirst + 2}) {
    EXPECT_EQ(ring_.find(index)->value, Vec3(9, 9, 9));
    EXPECT_EQ(ring_.find(index + 1)->value, value(index + 1));
  }
}

TEST(JitterBuffer, NothingIsInANewOne) {
  const auto buffer = std::make_unique<JitterBuffer>();
  for (const std::int64_t index : {-2, -1, 0, 1, 2, 8191}) EXPECT_EQ(buffer->find(index), nullptr) << index;
}

TEST(JitterBuffer, ASampleBeforeTheFirstTakesNobodysPlace) {
  auto buffer = std::make_unique<JitterBuffer>();
  StreamSample sample;
  sample.value = Vec3(1, 2, 3);
  buffer->store(JitterBuffer::kSize - 1, sample);
  sample.value = Vec3(4, 5, 6);
  buffer->store(-1, sample);
  EXPECT_EQ(buffer->find(-1), nullptr);
  ASSERT_NE(buffer->find(JitterBuffer::kSize - 1), nullptr);
  EXPECT_EQ(buffer->find(JitterBuffer::kSize - 1)->value, Vec3(1, 2, 3));
}

}  // namespace
}  // namespace telekerf::streaming
