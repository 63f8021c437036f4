// SPDX-License-Identifier: Apache-2.0
// What encoder, decoder and settings take at the last value within their bounds, and refuse beyond.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "common/codec/baselines/raw.h"
#include "common/codec/decoder.h"
#include "common/codec/encoder.h"
#include "common/runtime/startup_error.h"

namespace telekerf::codec {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes encoded(BlockEncoder& encoder, const std::vector<Vec3>& samples, const Trend& trend = {}) {
  Bytes bytes(4096);
  const auto size = encoder.encode(samples, 0, trend, bytes);
  EXPECT_TRUE(size);
  bytes.resize(size.value_or(0));
  return bytes;
}

TEST(Decoder, RemembersTheLast64SequenceNumbers) {
  BlockEncoder encoder({.block = 4, .redundancy = 0, .anchored = false});
  std::vector<Bytes> packets;
  for (int i = 0; i < 200; ++i)
    packets.push_back(encoded(encoder, std::vector<Vec3>(4, Vec3(1e-3 * i, 0, 0))));
  const auto taken = [&](BlockDecoder& decoder, std::size_t i) {
    return decoder.decode(packets[i], {}).has_value();
  };
  BlockDecoder decoder;
  EXPECT_TRUE(taken(decoder, 100));
  EXPECT_FALSE(taken(decoder, 100));
  EXPECT_TRUE(taken(decoder, 163)) << "63 further on";
  EXPECT_FALSE(taken(decoder, 100)) << "the oldest that is remembered";
  EXPECT_TRUE(taken(decoder, 101));
  EXPECT_FALSE(taken(decoder, 101));
  EXPECT_TRUE(taken(decoder, 164));
  EXPECT_TRUE(taken(decoder, 100)) << "64 back: a sender that began anew";
  EXPECT_TRUE(taken(decoder, 164)) << "its past is forgotten";
  BlockDecoder other;
  EXPECT_TRUE(taken(other, 10));
  EXPECT_TRUE(taken(other, 74));
  EXPECT_TRUE(taken(other, 75));
  EXPECT_TRUE(taken(other, 12)) << "63 back, never seen";
  EXPECT_FALSE(taken(other, 74));
  other.reset();
  EXPECT_TRUE(taken(other, 74));
  EXPECT_FALSE(taken(other, 74));
  EXPECT_EQ(other.counters().good, 5u);
  EXPECT_EQ(other.counters().of(CodecError::kReplayed), 2u);
}

TEST(Decoder, ConcealsByTheMotionOfTheLastFourSamplesFading) {
  BlockEncoder encoder({.block = 16, .keep = 16, .quantum = 1e-12});
  BlockDecoder decoder;
  std::vector<Vec3> samples(16, Vec3::Zero());
  for (int n = 0; n < 16; ++n)  // stands still, then moves on for the last four steps alone
    samples[static_cast<std::size_t>(n)] = Vec3(1e-4 * std::max(0, n - 11), 0.0, -2e-5 * n);
  const Trend trend{samples[0], Vec3::Zero()};
  ASSERT_TRUE(decoder.decode(encoded(encoder, samples, trend), trend));
  double x = 4e-4, z = -3e-4, moved = 1.0;
  for (int block = 0; block < 3; ++block) {
    const auto* made_up = decoder.conceal();
    ASSERT_NE(made_up, nullptr);
    EXPECT_EQ(made_up->blocks, 1);
    EXPECT_EQ(made_up->block_size, 16);
    ASSERT_EQ(made_up->blocks_newest_first[0].samples.size(), 16u);
    for (const Vec3& sample : made_up->blocks_newest_first[0].samples) {
      moved *= std::exp(-1.0 / 16.0);
      x += 1e-4 * moved;
      z -= 2e-5 * moved;
      EXPECT_NEAR(sample.x(), x, 1e-9);
      EXPECT_NEAR(sample.z(), z, 1e-9);
    }
  }
  EXPECT_EQ(decoder.concealed(), 3u);
  decoder.reset();
  EXPECT_EQ(decoder.conceal(), nullptr);
}

TEST(Encoder, TakesTheLargestMagnitudeAndRefusesAnyTrendThatIsNotFinite) {
  BlockEncoder encoder({.anchored = false});
  Bytes room(4096);
  std::vector<Vec3> samples(16, Vec3::Zero());
  samples[15].z() = -kMaxMagnitude;
  EXPECT_TRUE(encoder.encode(samples, 0, {}, room));
  samples[15].z() = std::nextafter(-kMaxMagnitude, -1e300);
  EXPECT_EQ(encoder.encode(samples, 0, {}, room).error(), CodecError::kOutOfRange);
  EXPECT_TRUE(encoder.decoded().empty()) << "no block after a refusal";
  samples[15].setZero();
  BlockDecoder decoder;
  const Bytes good = encoded(encoder, samples);
  for (const Trend& trend :
       {Trend{Vec3(0, 0, NAN), Vec3::Zero()}, Trend{Vec3::Zero(), Vec3(0, INFINITY, 0)}}) {
    EXPECT_EQ(encoder.encode(samples, 0, trend, room).error(), CodecError::kNotFinite);
    EXPECT_EQ(decoder.decode(good, trend).error(), CodecError::kNotFinite);
  }
  EXPECT_EQ(encoder.counters().good, 2u);
  EXPECT_EQ(encoder.counters().of(CodecError::kNotFinite), 2u);
}

TEST(Encoder, SendsAsManyCopiesAsFit) {
  std::vector<std::size_t> sizes;
  std::vector<Vec3> samples(16);
  const auto block = [&](int b) {
    for (int n = 0; n < 16; ++n) samples[static_cast<std::size_t>(n)] = Vec3(0.37 * ((7 * n + b) % 11), 0, 0);
    return samples;
  };
  const StreamSettings three = with_codec({.redundancy = 3, .anchored = false}, "batched");
  const auto blocks_in = [&](std::size_t room_bytes) {
    BlockEncoder encoder(three);
    BlockDecoder decoder;
    int blocks = 0;
    for (int b = 0; b < 5; ++b) {
      Bytes room(room_bytes);
      const auto size = encoder.encode(block(b), 0, {}, room);
      EXPECT_TRUE(size);
      const auto packet = decoder.decode(std::span(room).first(size.value_or(0)), {});
      EXPECT_TRUE(packet) << room_bytes;
      blocks = packet ? (*packet)->blocks : 0;
    }
    return blocks;
  };
  BlockEncoder encoder(three);
  for (int b = 0; b < 5; ++b) sizes.push_back(encoded(encoder, block(b)).size());
  EXPECT_EQ(sizes[3], sizes[4]) << "three copies and no more";
  for (std::size_t copies = 0; copies < 4; ++copies) {
    EXPECT_EQ(blocks_in(sizes[copies]), static_cast<int>(copies) + 1);
    if (copies > 0) {
      EXPECT_EQ(blocks_in(sizes[copies] - 1), static_cast<int>(copies));
    }
  }
  encoder.restart();
  EXPECT_EQ(encoded(encoder, block(5)).size(), sizes[0]) << "nothing from before the gap";
}

TEST(Settings, HoldTheirBounds) {
  struct Row {
    const char* name;
    StreamSettings good;
    StreamSettings bad;
  };
  const auto smallest = std::numeric_limits<double>::min();
  const std::vector<Row> rows{
      {"block", {.block = kMinTransform}, {.block = kMinTransform - 1}},
      {"block", {.block = 64}, {.block = 65}},
      {"block", {.kind = kRaw, .block = 1}, {.kind = kRaw, .block = 0}},
      {"keep", {.keep = 1}, {.keep = 0}},
      {"keep", {.block = 64, .keep = 64}, {.block = 64, .keep = 65}},
      {"keep", {.block = 8, .keep = 8}, {.block = 8, .keep = 9}},
      {"keep", {.kind = kRaw, .block = 1, .keep = 64}, {.kind = kRaw, .block = 1, .keep = 65}},
      {"max_rms", {.max_rms = 0.0}, {.max_rms = -smallest}},
      {"max_rms", {.max_rms = 1e6}, {.max_rms = std::nextafter(1e6, 2e6)}},
      {"redundancy", {.redundancy = 0}, {.redundancy = -1}},
      {"redundancy", {.redundancy = 7}, {.redundancy = 8}},
      {"quantum", {.quantum = 1e-15}, {.quantum = std::nextafter(1e-15, 0.0)}},
      {"quantum", {.quantum = 1e6}, {.quantum = std::nextafter(1e6, 2e6)}},
      {"threshold", {.threshold = 0.0}, {.threshold = -smallest}},
      {"threshold", {.threshold = 1e6}, {.threshold = std::nextafter(1e6, 2e6)}},
      {"sample_period_ns", {.sample_period_ns = 1000}, {.sample_period_ns = 999}},
      {"sample_period_ns", {.sample_period_ns = 1'000'000'000}, {.sample_period_ns = 1'000'000'001}},
      {"axes", {.axes = 1}, {.axes = 0}},
      {"axes", {.axes = 3}, {.axes = 4}},
  };
  for (const Row& row : rows) {
    EXPECT_NO_THROW((void)row.good.validated()) << row.name;
    try {
      (void)row.bad.validated();
      ADD_FAILURE() << row.name;
    } catch (const StartupError& refusal) {
      EXPECT_EQ(std::string(refusal.what()).find(fmt::format("codec: {} = ", row.name)), 0u)
          << refusal.what();
    }
  }
  EXPECT_EQ(StreamSettings({.kind = kRaw, .block = 1, .keep = 4}).validated().keep, 1) << "nothing reads it";
  EXPECT_THROW((void)StreamSettings{.kind = CodecKind{9}}.validated(), StartupError);
}

}  // namespace
}  // namespace telekerf::codec
