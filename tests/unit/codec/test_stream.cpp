// SPDX-License-Identifier: Apache-2.0
// Laws of encoder and decoder together.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>

#include "common/codec/baselines/raw.h"
#include "common/codec/decoder.h"
#include "common/codec/encoder.h"
#include "common/runtime/startup_error.h"

namespace telekerf::codec {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Hand motion: slow wandering, 9 Hz tremor of 50 um, encoder steps of 0.5 um.
Vec3 hand(double t) {
  using std::numbers::pi;
  const auto tremor = [&](double phase) { return 50e-6 * std::sin(2 * pi * 9 * t + phase); };
  const Vec3 p(0.02 * std::sin(2 * pi * 0.3 * t) + tremor(0),
               0.015 * std::sin(2 * pi * 0.23 * t + 1) + tremor(2), 0.1 + 1e-4 * std::sin(t));
  return (p / 5e-7).array().round() * 5e-7;
}

struct Sent {
  Bytes bytes;
  Trend trend;
  std::vector<Vec3> truth;
  std::vector<Vec3> decoded;
  std::uint64_t button = 0;
};

Trend trend_at(double t, double period) {
  Trend trend;
  trend.value = hand(t).cast<float>().cast<double>();
  trend.slope_per_sample =
      (((hand(t + 0.004) - hand(t - 0.004)) / 0.008).cast<float>().cast<double>()) * period;
  return trend;
}

std::vector<Sent> send_hand(const StreamSettings& settings, int blocks) {
  BlockEncoder encoder(settings);
  std::vector<Sent> all;
  std::mt19937 random(1);
  const double period = 1e-9 * settings.sample_period_ns;
  for (int b = 0; b < blocks; ++b) {
    Sent sent;
    const double start = b * settings.block * period;
    for (int n = 0; n < settings.block; ++n) sent.truth.push_back(hand(start + n * period));
    if (settings.anchored) sent.trend = trend_at(start, period);
    sent.button = b % 4 == 0 ? random() : (b % 4 == 1 ? ~0ull : (b % 4 == 2 ? 0xFF0ull << 2 : 0));
    if (settings.block < 64) sent.button &= (1ull << settings.block) - 1;
    sent.bytes.resize(2048);
    const auto size = encoder.encode(sent.truth, sent.button, sent.trend, sent.bytes);
    EXPECT_TRUE(size.has_value());
    sent.bytes.resize(size.value_or(0));
    sent.decoded.assign(encoder.decoded().begin(), encoder.decoded().end());
    all.push_back(sent);
  }
  return all;
}

bool same_bits(std::span<const Vec3> a, std::span<const Vec3> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

std::vector<StreamSettings> many_settings() {
  std::vector<StreamSettings> all;
  for (const bool anchored : {true, false}) {
    for (const int block : {4, 5, 16, 32, 64}) {
      for (const int redundancy : {0, 1, 3}) {
        all.push_back({.block = block, .keep = 4, .redundancy = redundancy, .anchored = anchored});
        all.push_back({.block = block, .max_rms = 2e-6, .redundancy = redundancy, .anchored = anchored});
      }
    }
    for (const auto* name : {"batched", "truncated", "deadband", "weber", "dpcm"}) {
      all.push_back(
          with_codec({.block = 16, .redundancy = 2, .threshold = 1e-4, .anchored = anchored}, name));
      all.push_back(with_codec({.block = 16, .max_rms = 2e-6, .redundancy = 1, .anchored = anchored}, name));
      all.push_back(with_codec({.block = 64, .redundancy = 1, .anchored = anchored}, name));
    }
    all.push_back({.block = 16, .integrated = true, .anchored = anchored});
    all.push_back({.block = 16, .axes = 1, .anchored = anchored});
    all.push_back({.block = 16, .axes = 2, .anchored = anchored});
    all.push_back({.kind = kRaw, .block = 1, .redundancy = 0, .anchored = anchored});
  }
  return all;
}

TEST(Stream, EveryPacketDecodesAloneToWhatTheEncoderSaidBitForBit) {
  for (const auto& settings : many_settings()) {
    const auto sent = send_hand(settings, 40);
    for (std::size_t i = 0; i < sent.size(); ++i) {
      BlockDecoder decoder;  // a fresh one: nothing else was received
      const auto packet = decoder.decode(sent[i].bytes, sent[i].trend);
      ASSERT_TRUE(packet.has_value()) << to_string(packet.error());
      ASSERT_EQ((*packet)->blocks, std::min<int>(static_cast<int>(i), settings.redundancy) + 1);
      EXPECT_EQ((*packet)->block_size, settings.block);
      EXPECT_EQ((*packet)->head.sample_period_ns, settings.sample_period_ns);
      for (int age = 0; age < (*packet)->blocks; ++age) {
        const auto& block = (*packet)->blocks_newest_first[static_cast<std::size_t>(age)];
        const auto& original = sent[i - static_cast<std::size_t>(age)];
        EXPECT_TRUE(same_bits(block.samples, original.decoded))
            << "N " << settings.block << " packet " << i << " age " << age << " anchored "
            << settings.anchored;
        EXPECT_EQ(block.button, original.button) << "packet " << i << " age " << age;
      }
    }
  }
}

TEST(Stream, AdaptiveKeepsItsPromiseOnEveryBlockAndAxis) {
  for (const double max_rms : {1e-7, 1e-6, 1e-5, 1e-3}) {
    for (const bool anchored : {true, false}) {
      for (const auto& sent : send_hand({.block = 32, .max_rms = max_rms, .anchored = anchored}, 60)) {
        for (int a = 0; a < kAxes; ++a) {
          double sum = 0;
          for (std::size_t n = 0; n < sent.truth.size(); ++n)
            sum += std::pow(sent.truth[n][a] - sent.decoded[n][a], 2);
          EXPECT_LE(std::sqrt(sum / 32), max_rms);
        }
      }
    }
  }
}

TEST(Stream, WithAllCoefficientsOnlyTheStepIsLost) {
  for (const auto& sent : send_hand({.block = 16, .keep = 16, .quantum = 1e-13, .anchored = true}, 10)) {
    for (std::size_t n = 0; n < sent.truth.size(); ++n)
      EXPECT_LT((sent.truth[n] - sent.decoded[n]).norm(), 1e-12);
  }
}

TEST(Stream, DefaultSettingsFollowAHandToAMicrometreWithoutChatterAtTheEdges) {
  double squares = 0, jumps = 0, bytes = 0;
  int samples = 0, edges = 0;
  Vec3 last_error = Vec3::Zero();
  const auto all = send_hand({}, 600);
  for (const auto& sent : all) {
    for (std::size_t n = 0; n < sent.truth.size(); ++n) {
      const Vec3 error = sent.decoded[n] - sent.truth[n];
      squares += error.squaredNorm() / 3;
      ++samples;
      if (n == 0) {
        jumps += (error - last_error).squaredNorm() / 3;
        ++edges;
      }
      last_error = error;
    }
    bytes += static_cast<double>(sent.bytes.size());
  }
  EXPECT_LT(std::sqrt(squares / samples), 1e-6);
  EXPECT_LT(std::sqrt(jumps / edges), 1e-6);
  EXPECT_LT(bytes / static_cast<double>(all.size()), 53);
}

TEST(Stream, JumpsAndHeldSignalsAreTakenAsStairs) {
  for (const bool anchored : {true, false}) {
    for (const double max_rms : {0.0, 1e-6}) {
      const StreamSettings settings{.block = 32, .max_rms = max_rms, .redundancy = 2, .anchored = anchored};
      BlockEncoder encoder(settings);
      BlockEncoder truncated(with_codec(settings, "truncated"));
      BlockDecoder decoder;
      std::mt19937 random(6);
      std::vector<std::uint8_t> packet(1024);
      std::vector<std::vector<Vec3>> history;
      Vec3 level = Vec3::Zero();
      for (int b = 0; b < 30; ++b) {
        std::vector<Vec3> samples;
        const auto jump = random() % 64;
        for (unsigned n = 0; n < 32; ++n) {
          if (n == jump) level += Vec3(0.01, -0.02, 0.001) * static_cast<double>(random() % 5);
          samples.push_back(level);
        }
        const Trend trend{anchored ? samples[0].cast<float>().cast<double>().eval() : Vec3::Zero(),
                          Vec3::Zero()};
        const auto size = encoder.encode(samples, 0, trend, packet);
        ASSERT_TRUE(size);
        if (max_rms > 0 && encoder.decoded().front() != encoder.decoded().back()) {
          std::vector<std::uint8_t> room(1024);
          ASSERT_TRUE(truncated.encode(samples, 0, trend, room));
          EXPECT_LT(3 * encoder.newest_block_bits(), truncated.newest_block_bits());
        }
        for (std::size_t n = 0; n < 32; ++n) EXPECT_LT((encoder.decoded()[n] - samples[n]).norm(), 2e-6);
        history.emplace_back(encoder.decoded().begin(), encoder.decoded().end());
        const auto got = decoder.decode(std::span(packet).first(*size), trend);
        ASSERT_TRUE(got);
        for (std::size_t age = 0; age < static_cast<std::size_t>((*got)->blocks); ++age) {
          EXPECT_TRUE(same_bits((*got)->blocks_newest_first[age].samples, history[history.size() - 1 - age]));
        }
      }
    }
  }
}

TEST(Stream, BadSamplesAreRefusedCountedAndLeaveTheStreamClean) {
  BlockEncoder encoder({});
  BlockDecoder decoder;
  Bytes room(2048);
  std::vector<Vec3> samples(16, Vec3(1e-3, 0, 0));
  ASSERT_TRUE(encoder.encode(samples, 0, {}, room));
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300}) {
    auto broken = samples;
    broken[7].y() = bad;
    EXPECT_FALSE(encoder.encode(broken, 0, {}, room));
  }
  EXPECT_EQ(encoder.counters().of(CodecError::kNotFinite), 2u);
  EXPECT_EQ(encoder.counters().of(CodecError::kOutOfRange), 1u);
  EXPECT_EQ(encoder.encode(std::span(samples).first(15), 0, {}, room).error(), CodecError::kWrongSize);
  EXPECT_EQ(encoder.encode(samples, 0, {}, std::span(room).first(9)).error(), CodecError::kNoRoom);
  samples[3].z() = std::numeric_limits<double>::denorm_min();
  samples[4].z() = 1e29;
  const auto size = encoder.encode(samples, 0, {}, room);
  ASSERT_TRUE(size);
  const auto packet = decoder.decode(std::span(room).first(*size), {});
  ASSERT_TRUE(packet);
  EXPECT_EQ((*packet)->blocks, 1);  // nothing of before the gap
  EXPECT_TRUE(same_bits((*packet)->blocks_newest_first[0].samples, encoder.decoded()));
}

TEST(Stream, HostileBytesNeverDecodeToNonsense) {
  std::mt19937 random(99);
  BlockDecoder decoder;
  const auto good = send_hand({.block = 16, .redundancy = 2}, 20);
  std::uint64_t accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    const auto& origin = good[static_cast<std::size_t>(round) % good.size()];
    auto bytes = origin.bytes;
    if (round % 3 == 0) {
      for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
      bytes[0] = static_cast<std::uint8_t>(kPacketVersion << 4 | (random() % 4));
    } else {
      for (int flips = 1 + static_cast<int>(random() % 4); flips > 0; --flips) {
        bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
      }
    }
    bytes.resize(random() % (bytes.size() + 1));
    bytes.shrink_to_fit();  // the sanitizers see the true end
    decoder.reset();
    const auto packet = decoder.decode(bytes, origin.trend);
    if (!packet) continue;
    ++accepted;
    for (int age = 0; age < (*packet)->blocks; ++age) {
      for (const auto& sample : (*packet)->blocks_newest_first[static_cast<std::size_t>(age)].samples) {
        ASSERT_TRUE(sample.allFinite());
      }
    }
  }
  EXPECT_EQ(accepted, decoder.counters().good);
}

TEST(Stream, WrongVersionTruncatedAndReplayedPacketsAreRefusedAndCounted) {
  BlockDecoder decoder;
  const auto sent = send_hand({}, 3);
  auto other_version = sent[0].bytes;
  other_version[0] ^= 0xF0;
  EXPECT_EQ(decoder.decode(other_version, sent[0].trend).error(), CodecError::kWrongVersion);
  for (std::size_t size = 0; size < sent[1].bytes.size(); ++size) {
    EXPECT_FALSE(decoder.decode(std::span(sent[1].bytes).first(size), sent[1].trend)) << size;
  }
  EXPECT_TRUE(decoder.decode(sent[2].bytes, sent[2].trend));
  EXPECT_TRUE(decoder.decode(sent[1].bytes, sent[1].trend));  // late is not replayed
  EXPECT_EQ(decoder.decode(sent[1].bytes, sent[1].trend).error(), CodecError::kReplayed);
  EXPECT_EQ(decoder.counters().of(CodecError::kReplayed), 1u);
  EXPECT_EQ(decoder.counters().good, 2u);
}

TEST(Stream, ChangedSettingsInMidRunAreFollowed) {
  BlockDecoder decoder;
  for (const auto& settings : many_settings()) {
    decoder.reset();
    for (const auto& sent : send_hand(settings, 3)) {
      const auto packet = decoder.decode(sent.bytes, sent.trend);
      ASSERT_TRUE(packet);
      EXPECT_TRUE(same_bits((*packet)->blocks_newest_first[0].samples, sent.decoded));
    }
  }
}

/// Twice integrated from rest, as a receiver of accelerations does.
double integrated_error(std::span<const Vec3> truth, std::span<const Vec3> decoded) {
  double velocity = 0, position = 0, squares = 0;
  for (std::size_t n = 0; n < truth.size(); ++n) {
    velocity += decoded[n].x() - truth[n].x();
    position += velocity;
    squares += position * position;
  }
  return squares;
}

TEST(Stream, IntegratedSamplesKeepWhatMovesTheIntegral) {
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0.0, 0.05);
  StreamSettings plain{.block = 16, .keep = 3, .redundancy = 0, .quantum = 0.01, .anchored = false};
  StreamSettings integrated = plain;
  integrated.integrated = true;
  BlockEncoder usual(plain);
  BlockEncoder by_integral(integrated);
  Bytes bytes(2048);
  double usual_squares = 0, squares = 0;
  std::size_t usual_bits = 0, bits = 0;
  for (int b = 0; b < 500; ++b) {
    std::vector<Vec3> samples;
    samples.reserve(16);
    for (int n = 0; n < 16; ++n) {
      samples.emplace_back(0.3 * std::sin(0.06 * (16 * b + n)) + noise(random), noise(random), 0.0);
    }
    ASSERT_TRUE(usual.encode(samples, 0, {}, bytes));
    usual_squares += integrated_error(samples, usual.decoded());
    usual_bits += usual.newest_block_bits();
    ASSERT_TRUE(by_integral.encode(samples, 0, {}, bytes));
    squares += integrated_error(samples, by_integral.decoded());
    bits += by_integral.newest_block_bits();
  }
  EXPECT_LT(squares, 0.25 * usual_squares);
  EXPECT_LT(4 * bits, 3 * usual_bits);
}

TEST(Stream, AnEncoderChangesItsSettingsWithoutABreak) {
  BlockEncoder encoder(StreamSettings{});
  BlockDecoder decoder;
  Bytes bytes(8192);
  double t = 0.0;
  std::uint64_t packets = 0;
  for (const auto& settings : many_settings()) {
    encoder.change(settings);
    EXPECT_THROW(encoder.change({.block = 65}), StartupError) << "and nothing changes";
    for (int b = 0; b < 3; ++b) {
      std::vector<Vec3> samples;
      const Trend trend = settings.anchored ? trend_at(t, 1e-3) : Trend{};
      for (int n = 0; n < settings.block; ++n, t += 1e-3) samples.push_back(hand(t));
      const auto size = encoder.encode(samples, 0, trend, bytes);
      ASSERT_TRUE(size);
      const auto packet = decoder.decode(std::span(bytes).first(*size), trend);
      ASSERT_TRUE(packet) << to_string(packet.error());
      EXPECT_EQ((*packet)->blocks, std::min(b, settings.redundancy) + 1) << "no copy under other settings";
      EXPECT_EQ((*packet)->block_size, settings.block);
      EXPECT_TRUE(same_bits((*packet)->blocks_newest_first[0].samples, encoder.decoded()));
      ++packets;
    }
  }
  EXPECT_EQ(decoder.counters().good, packets);
}

TEST(Stream, APacketRepeatsAsManyBlocksAsItIsAskedToAndTheyAreThere) {
  BlockEncoder encoder(StreamSettings{.redundancy = 1});
  BlockDecoder decoder;
  Bytes bytes(2048);
  double t = 0.0;
  std::vector<std::vector<Vec3>> decoded;
  const int asked[] = {1, 1, 1, 1, 5, 7, 7, 7, 7, 0, 9, -1, 2};
  const int carried[] = {0, 1, 1, 1, 4, 5, 6, 7, 7, 0, 7, 0, 2};
  for (std::size_t b = 0; b < std::size(asked); ++b) {
    if (b > 0) encoder.repeat(asked[b]);
    std::vector<Vec3> samples;
    const Trend trend = trend_at(t, 1e-3);
    for (int n = 0; n < 16; ++n, t += 1e-3) samples.push_back(hand(t));
    const auto size = encoder.encode(samples, 0, trend, bytes);
    ASSERT_TRUE(size);
    EXPECT_EQ(encoder.copies(), carried[b]) << b;
    decoded.emplace_back(encoder.decoded().begin(), encoder.decoded().end());
    const auto packet = decoder.decode(std::span(bytes).first(*size), trend);
    ASSERT_TRUE(packet) << to_string(packet.error());
    ASSERT_EQ((*packet)->blocks, carried[b] + 1) << b;
    for (std::size_t age = 0; age <= static_cast<std::size_t>(carried[b]); ++age) {
      EXPECT_TRUE(same_bits((*packet)->blocks_newest_first[age].samples, decoded[b - age]))
          << b << ' ' << age;
    }
  }
}

TEST(Settings, RefusalsNameSettingValueAndBound) {
  const auto refusal = [](const StreamSettings& settings) -> std::string {
    try {
      (void)settings.validated();
    } catch (const StartupError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal({.block = 3}), "codec: block = 3: must lie within [4, 64]");
  EXPECT_NE(refusal({.keep = 0}), "");
  EXPECT_NE(refusal({.max_rms = std::nan("")}), "");
  EXPECT_NE(refusal({.redundancy = 8}), "");
  EXPECT_EQ(refusal({}), "");
  EXPECT_THROW(with_codec({}, "zip"), StartupError);
}

}  // namespace
}  // namespace telekerf::codec
