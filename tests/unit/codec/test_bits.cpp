// SPDX-License-Identifier: Apache-2.0
// Values just inside and just outside of every bound of the bit stream, its parts and the packet's head.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "common/codec/baselines/raw.h"
#include "common/codec/packet.h"
#include "common/codec/raw_samples.h"
#include "common/codec/run_length.h"

namespace telekerf::codec {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(Bits, GolombCodesHaveTheLengthsOfTheStandard) {
  // Order 0: 1, 010, 011, 00100 ...; order k: the value's lowest k bits behind the code of the rest.
  for (const auto& [value, order, bits] : {std::tuple{0ULL, 0, 1},
                                           {1ULL, 0, 3},
                                           {2ULL, 0, 3},
                                           {3ULL, 0, 5},
                                           {6ULL, 0, 5},
                                           {7ULL, 0, 7},
                                           {7ULL, 3, 4},
                                           {8ULL, 3, 6},
                                           {kMaxGolomb, 0, 97},
                                           {kMaxGolomb - 1, 0, 95},
                                           {kMaxGolomb, 10, 87}}) {
    EXPECT_EQ(golomb_bits(value, order), bits) << value << " order " << order;
    Bytes room(16);
    BitWriter writer(room);
    writer.golomb(value, order);
    EXPECT_EQ(writer.position(), static_cast<std::size_t>(bits));
    BitReader reader(room);
    EXPECT_EQ(reader.golomb(order), value);
    EXPECT_FALSE(reader.failed());
  }
  Bytes one(1, 0xFF);
  BitWriter writer(one);
  writer.golomb(5, 1);  // 5 = 2 * 2 + 1: 011, 1
  EXPECT_EQ(one[0], 0b0111'0000);
  for (const std::int64_t value : {0LL, -1LL, 1LL, -2LL, 2LL})
    EXPECT_EQ(zigzag(value), static_cast<std::uint64_t>(value < 0 ? -2 * value - 1 : 2 * value));
  EXPECT_EQ(unzigzag(zigzag(-(1LL << 62))), -(1LL << 62));
}

TEST(Bits, LongerCodesThanTheLongestAreMalformed) {
  for (const int order : {0, 10}) {
    for (const int zeros : {kMaxGolombBits - order, kMaxGolombBits - order + 1}) {
      Bytes room(40, 0);
      BitWriter writer(room);
      writer.bits(0, zeros);
      writer.bits(1, 1);
      BitReader reader(room);
      (void)reader.golomb(order);
      EXPECT_EQ(reader.malformed(), zeros + order > kMaxGolombBits) << zeros << " order " << order;
      EXPECT_FALSE(reader.truncated());
    }
  }
  Bytes room(40);
  BitWriter writer(room);
  writer.golomb(kMaxGolomb, 0);
  EXPECT_FALSE(writer.overflowed());
  writer.golomb(kMaxGolomb + 1, 0);
  EXPECT_TRUE(writer.overflowed());
}

TEST(Bits, TheLastBitFitsAndNoneBeyond) {
  Bytes room(3, 0xAA);
  BitWriter writer(room);
  writer.bits(0x1FFFF, 17);
  writer.bits(0x7F, 7);
  EXPECT_FALSE(writer.overflowed());
  EXPECT_EQ(writer.bytes(), 3u);
  writer.bits(1, 1);
  EXPECT_TRUE(writer.overflowed());
  EXPECT_EQ(writer.position(), 24u);
  writer.rewind(17);
  EXPECT_FALSE(writer.overflowed());
  EXPECT_EQ(room[2], 0x80) << "what was written behind is gone";
  EXPECT_EQ(writer.bytes(), 3u);
  writer.rewind(16);
  EXPECT_EQ(writer.bytes(), 2u);

  BitReader reader(room);
  EXPECT_EQ(reader.bits(17), 0x1FFFFu);
  EXPECT_EQ(reader.bits(7), 0u);
  EXPECT_FALSE(reader.truncated());
  EXPECT_EQ(reader.bits(1), 0u);
  EXPECT_TRUE(reader.truncated());
}

TEST(Bits, AllButPaddingAtTheEndIsUnclean) {
  for (const auto& [last, read, clean] : {std::tuple{0x80, 9, true},
                                          {0x81, 9, false},
                                          {0xC0, 9, false},
                                          {0x00, 8, false},  // a whole byte is no padding
                                          {0xFF, 16, true}}) {
    const Bytes bytes{0xFF, static_cast<std::uint8_t>(last)};
    BitReader reader(bytes);
    (void)reader.bits(read);
    EXPECT_EQ(reader.at_clean_end(), clean) << last << " after " << read;
  }
}

/// What the head reads as after one change of it.
template <typename Change>
tl::expected<PacketHead, CodecError> head_with(const Change& change) {
  PacketHead head;
  head.blocks = 3;
  head.redundancy = 2;
  head.sequence = 65535;
  head.sample_period_ns = 1'000'000;
  head.quantum_exponent = -80;
  head.adaptive = true;
  head.model = {.count = 63, .step_offset = 31, .level_order = 31, .value_order = 15};
  change(head);
  Bytes bytes(32);
  BitWriter writer(bytes);
  write_head(writer, head);
  EXPECT_FALSE(writer.overflowed());
  BitReader reader(bytes);
  return read_head(reader);
}

TEST(PacketHead, ComesBackWholeAndKeepsItsBounds) {
  const auto whole = head_with([](PacketHead&) {});
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->blocks, 3);
  EXPECT_EQ(whole->sequence, 65535);
  EXPECT_EQ(whole->quantum_exponent, -80);
  EXPECT_TRUE(whole->adaptive);
  EXPECT_FALSE(whole->integrated);
  EXPECT_EQ(whole->model.count, 63);
  EXPECT_EQ(whole->model.step_offset, 31);
  EXPECT_EQ(whole->model.level_order, 31);
  EXPECT_EQ(whole->model.value_order, 15);
  const auto good = [](const auto& change) { return head_with(change).has_value(); };
  EXPECT_TRUE(good([](PacketHead& h) { h.block = kMinTransform; }));
  EXPECT_FALSE(good([](PacketHead& h) { h.block = kMinTransform - 1; }));
  EXPECT_TRUE(good([](PacketHead& h) { h.block = 64; }));
  EXPECT_TRUE(good([](PacketHead& h) { h.kind = kRaw, h.block = 1; }));
  EXPECT_TRUE(good([](PacketHead& h) { h.axes = 1; }));
  EXPECT_FALSE(good([](PacketHead& h) { h.axes = 0; }));
  EXPECT_FALSE(good([](PacketHead& h) { h.integrated = true; })) << "no promise is kept at steps that differ";
  EXPECT_TRUE(good([](PacketHead& h) { h.integrated = true, h.adaptive = false; }));
  EXPECT_FALSE(good([](PacketHead& h) { h.model.value_order = 16; }));
  EXPECT_FALSE(good([](PacketHead& h) { h.redundancy = 1; })) << "more blocks than its redundancy allows";
  EXPECT_TRUE(good([](PacketHead& h) { h.blocks = 8, h.redundancy = 7; }));
  EXPECT_FALSE(good([](PacketHead& h) { h.sample_period_ns = 0; }));
  EXPECT_TRUE(good([](PacketHead& h) { h.sample_period_ns = 1; }));
  EXPECT_TRUE(good([](PacketHead& h) { h.sample_period_ns = 1'000'000'000; }));
  EXPECT_FALSE(good([](PacketHead& h) { h.sample_period_ns = 1'000'000'001; }));
  EXPECT_FALSE(good([](PacketHead& h) { h.kind = CodecKind{15}; }));
  for (const int exponent : {-kMaxQuantumExponent, kMaxQuantumExponent}) {
    const auto head = head_with([&](PacketHead& h) { h.quantum_exponent = exponent; });
    ASSERT_TRUE(head);
    EXPECT_EQ(head->quantum_exponent, exponent);
  }
}

TEST(Grid, StepsAreQuarterOctavesOfTheFinest) {
  EXPECT_EQ(Grid(16, 0).level, 1.0);
  EXPECT_EQ(Grid(16, -8).level, 0.25);
  EXPECT_NEAR(Grid(16, -7).level, std::exp2(-1.75), 1e-15);
  EXPECT_NEAR(Grid(16, 5).level, std::exp2(1.25), 1e-15);
  EXPECT_NEAR(Grid(16, 0).step(3), std::exp2(1.5), 1e-15);
  // Four quanta at the block's end, its length rounded up to a power of two.
  for (const auto& [block, length] : {std::pair{16, 16.0}, {17, 32.0}, {4, 4.0}, {64, 64.0}}) {
    EXPECT_EQ(Grid(block, 0).slope, 4.0 / length) << block;
    EXPECT_EQ(Grid(block, 0).bend, 8.0 / (length * length)) << block;
  }
  EXPECT_EQ(on_grid(2.4, 1.0), 2);
  EXPECT_EQ(on_grid(-2.6, 1.0), -3);
  EXPECT_EQ(on_grid(1e300, 1.0), kMaxParameter);
  EXPECT_EQ(on_grid(-1e300, 1.0), -kMaxParameter);
  const double most = 0.5 * static_cast<double>(kMaxValue);
  EXPECT_EQ(min_step_offset(std::vector<double>{std::nextafter(most, 0.0)}, Grid(16, 0)), 0);
  EXPECT_EQ(min_step_offset(std::vector<double>{0.0, -most}, Grid(16, 0)), 1);
  EXPECT_EQ(min_step_offset(std::vector<double>{2.0 * most}, Grid(16, 0)), 3);
  EXPECT_EQ(min_step_offset(std::vector<double>{1e300}, Grid(16, -255)), kMaxStepOffset);
}

TEST(RunLength, HoldsWithinTheBandAndNotBeyond) {
  AxisCode code;
  const std::vector<double> samples{1.0, 1.25, 1.5, 1.51, 1.0, 0.99, 3.0};
  const double energy = hold_within(samples, {.absolute = 0.5}, 0.01, code);
  EXPECT_EQ(std::vector<std::int64_t>(code.values.begin(), code.values.begin() + 7),
            (std::vector<std::int64_t>{100, 100, 100, 151, 100, 100, 300}));
  EXPECT_EQ(code.set, 0b1011001u);
  EXPECT_NEAR(energy, 0.25 * 0.25 + 0.5 * 0.5 + 0.01 * 0.01, 1e-12);
  hold_within(std::vector<double>{-2.0, -2.25, -2.6, -2.4}, {.absolute = 0.25, .relative = 0.125}, 0.01,
              code);
  EXPECT_EQ(code.set, 0b101u) << "a quarter of an absolute band and one of an eighth of 2";
  hold_within(std::vector<double>{1.0, 1.6, 1.55}, {.absolute = 0.5}, 1.0, code);
  EXPECT_EQ(code.set, 0b11u) << "1.55 is within the band of 2";
}

/// Reads a body of runs that has these events: how many, then run and step of each.
bool reads(std::uint64_t events, const std::vector<std::pair<std::uint64_t, std::int64_t>>& runs, int block,
           std::int64_t first = 0) {
  Bytes bytes(256);
  BitWriter writer(bytes);
  writer.golomb(events, 1);
  int order = 2;
  for (const auto& [run, step] : runs) {
    writer.golomb(run, 1);
    writer.signed_golomb(step, order);
    order = std::clamp(static_cast<int>(std::bit_width(zigzag(step))) - 2, 0, 31);
  }
  AxisCode code;
  code.values[0] = first;
  BitReader reader(bytes);
  return read_runs(reader, code, block);
}

TEST(RunLength, WhatNoEncoderWritesIsRefused) {
  EXPECT_TRUE(reads(1, {{14, 3}}, 16));
  EXPECT_FALSE(reads(1, {{15, 3}}, 16)) << "beyond the block's end";
  EXPECT_TRUE(reads(2, {{0, 3}, {13, 1}}, 16));
  EXPECT_FALSE(reads(2, {{0, 3}, {14, 1}}, 16));
  EXPECT_TRUE(reads(3, {{0, 1}, {0, 1}, {0, 1}}, 4));
  EXPECT_FALSE(reads(4, {{0, 1}, {0, 1}, {0, 1}, {0, 1}}, 4));
  EXPECT_TRUE(reads(1, {{0, 4 * kMaxValue}}, 4));
  EXPECT_FALSE(reads(1, {{0, 4 * kMaxValue + 1}}, 4));
  EXPECT_TRUE(reads(2, {{0, 4 * kMaxValue}, {0, 4 * kMaxValue}}, 4));
  EXPECT_FALSE(reads(2, {{0, 4 * kMaxValue}, {0, 4 * kMaxValue}}, 4, 1));
  EXPECT_FALSE(reads(2, {{0, -4 * kMaxValue}, {0, -4 * kMaxValue}}, 4, -1));
}

TEST(RawSamples, TheLargestThatIsSentIsTheLargestThatIsRead) {
  const auto reads_float = [](float value) {
    AxisCode code;
    code.raw[0] = value;
    Bytes bytes(4);
    BitWriter writer(bytes);
    write_raw_samples(writer, code, 1);
    BitReader reader(bytes);
    double sample = 0.0;
    return read_raw_samples(reader, {&sample, 1});
  };
  const auto most = static_cast<float>(kMaxMagnitude);
  EXPECT_TRUE(reads_float(most));
  EXPECT_TRUE(reads_float(-most));
  EXPECT_FALSE(reads_float(std::nextafter(most, 1e38F)));
  EXPECT_FALSE(reads_float(std::numeric_limits<float>::quiet_NaN()));
}

}  // namespace
}  // namespace telekerf::codec
