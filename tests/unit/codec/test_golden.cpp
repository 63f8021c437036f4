// SPDX-License-Identifier: Apache-2.0
// What a stream is worth: exact sizes, packets and decoded samples of fixed streams. A change of any of them
// is a change of the format or of its efficiency; a wanted one is written down here.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "common/codec/decoder.h"
#include "common/codec/encoder.h"

namespace telekerf::codec {
namespace {

constexpr int kBlocks = 100;

/// FNV-1a.
class Digest {
 public:
  void add(std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) value_ = (value_ ^ byte) * 0x100000001B3ULL;
  }
  void add(std::span<const Vec3> samples) {
    add({reinterpret_cast<const std::uint8_t*>(samples.data()), samples.size_bytes()});
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325ULL;
};

/// A swing by its recurrence: no library's sine, the same everywhere once it is rounded.
class Swing {
 public:
  Swing(double amplitude, double per_sample, double phase)
      : before_(amplitude * phase), now_(amplitude), twice_cosine_(2.0 - per_sample * per_sample) {}
  double next() {
    const double then = twice_cosine_ * now_ - before_;
    before_ = now_;
    now_ = then;
    return now_;
  }

 private:
  double before_, now_, twice_cosine_;
};

/// Three axes by turns smooth, at rest, trembling, jumping and noisy.
std::vector<Vec3> signal(int samples) {
  std::vector<Vec3> out;
  Swing wide(0.02, 1.9e-3, 0.999);
  Swing wide_too(0.015, 1.4e-3, 0.9995);
  Swing tremor(50e-6, 0.056, 0.99);
  Swing quick(4e-3, 0.31, 0.9);
  std::uint64_t state = 1;
  const auto noise = [&] {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state >> 44) * 0x1p-20 - 0.5;
  };
  double level = 0.0;
  for (int n = 0; n < samples; ++n) {
    const int part = 8 * n / samples;
    const double w = wide.next(), u = wide_too.next(), t = tremor.next(), q = quick.next(), r = noise();
    if (n % 37 == 0) level += 4e-3 * noise();
    Vec3 p(w + t, u - 0.7 * t, level);
    if (part == 1) p = Vec3(w, q, 1e-3);
    if (part == 3) p = Vec3(level, -2.0 * level, 0.0);
    if (part == 5) p = Vec3(2e-3 * r, w + 1e-5 * r, q + 1e-4 * r);
    if (part == 6) p = Vec3(1e-5 * (n % 64), 2e-8 * (n % 64) * (n % 64), n % 90 == 0 ? 0.3 : 0.0);
    out.push_back((p / 5e-8).array().round() * 5e-8);
  }
  return out;
}

struct Golden {
  const char* what;
  StreamSettings settings;
  std::size_t bytes;
  std::size_t newest_bits;
  std::uint64_t packets;
  std::uint64_t decoded;
};

Golden measured(Golden row) {
  BlockEncoder encoder(row.settings);
  BlockDecoder decoder;
  const int block = row.settings.block;
  const std::vector<Vec3> all = signal(kBlocks * block);
  Digest packets, decoded;
  std::vector<std::uint8_t> room(16384);
  row.bytes = row.newest_bits = 0;
  for (int b = 0; b < kBlocks; ++b) {
    const auto samples =
        std::span(all).subspan(static_cast<std::size_t>(b * block), static_cast<std::size_t>(block));
    Trend trend;
    if (row.settings.anchored) {
      trend.value = samples[0];
      if (b > 0) trend.slope_per_sample = samples[0] - samples.data()[-1];
    }
    const std::uint64_t button = b % 5 == 0 ? ~0ULL : (b % 5 == 1 ? 0xFF0ULL : (b % 5 == 2 ? 0x5ULL : 0ULL));
    const auto size = encoder.encode(samples, button, trend, room);
    EXPECT_TRUE(size) << row.what;
    if (!size) break;
    const auto packet = std::span<const std::uint8_t>(room).first(*size);
    const auto got = decoder.decode(packet, trend);
    EXPECT_TRUE(got) << row.what;
    row.bytes += *size;
    row.newest_bits += encoder.newest_block_bits();
    packets.add(packet);
    if (got) decoded.add((*got)->blocks_newest_first[0].samples);
  }
  row.packets = packets.value();
  row.decoded = decoded.value();
  return row;
}

const std::vector<Golden>& golden() {
  const auto named = [](const char* name, StreamSettings settings) { return with_codec(settings, name); };
  static const std::vector<Golden> rows{
      {"sdct 16, anchored", {.anchored = true}, 4542, 12249, 0x29c439a328831e90, 0xe54f4776dc204631},
      {"sdct 4, anchored",
       {.block = 4, .redundancy = 0, .anchored = true},
       2014,
       6324,
       0xc1f3657594ad9f1a,
       0xaa43576f25f58ae8},
      {"sdct 33, anchored",
       {.block = 33, .keep = 9, .redundancy = 2, .quantum = 1e-7, .anchored = true},
       12006,
       26789,
       0xb76f957aa8acb00f,
       0x588c779bd6e9fab6},
      {"sdct 64, anchored",
       {.block = 64, .keep = 20, .redundancy = 3, .anchored = true},
       21025,
       38064,
       0x3f3d5ee84b6941b5,
       0x0854b9f190aa8bc7},
      {"sdct 16 to 2 um, anchored",
       {.max_rms = 2e-6, .anchored = true},
       4505,
       12193,
       0x34729d4c6373b2e8,
       0x405206718133ea00},
      {"sdct 32 to 0.1 um, anchored",
       {.block = 32, .max_rms = 1e-7, .redundancy = 2, .anchored = true},
       14384,
       33534,
       0x159948f8eeb77a45,
       0x25be9c43d7161464},
      {"sdct 64 to 50 um, anchored",
       {.block = 64, .max_rms = 5e-5, .redundancy = 7, .anchored = true},
       20151,
       17948,
       0xc46559ffcd8115ce,
       0x005e4982866ebf2b},
      {"sdct integrated, anchored",
       {.keep = 3, .integrated = true, .anchored = true},
       4864,
       12924,
       0xaa80528b7eddf526,
       0xf70786c8fa5f3445},
      {"sdct integrated to 1 um, anchored",
       {.max_rms = 1e-6, .integrated = true, .anchored = true},
       4841,
       13471,
       0xc778928686f5bd6d,
       0xd7723f86405f1985},
      {"one axis, anchored",
       {.axes = 1, .anchored = true},
       2379,
       4297,
       0x8e618d356f939450,
       0x1264e66f376f0934},
      {"truncated, anchored", named("truncated", {.anchored = true}), 5158, 15986, 0xf9ba732e3fb3615f,
       0x2b0de95528ef2712},
      {"truncated to 2 um, anchored", named("truncated", {.block = 32, .max_rms = 2e-6, .anchored = true}),
       12972, 47936, 0x71d989cc1161063e, 0x9f9a60f779f4eacf},
      {"sdct 16, free", {.anchored = false}, 5021, 16683, 0xc9bb4e3e1ba04866, 0xb3cbb27cad356281},
      {"sdct 4, free",
       {.block = 4, .redundancy = 0, .anchored = false},
       2509,
       10126,
       0x9149572c1b234f0c,
       0x86579bc416d47416},
      {"sdct 33, free",
       {.block = 33, .keep = 9, .redundancy = 2, .quantum = 1e-7, .anchored = false},
       12755,
       32920,
       0x02ae22b1cde83100,
       0x89d7f018f70ef3c1},
      {"sdct 64, free",
       {.block = 64, .keep = 20, .redundancy = 3, .anchored = false},
       20161,
       40079,
       0x12a795cfe12afa11,
       0x2a025b703a8ade8f},
      {"sdct 16 to 2 um, free",
       {.max_rms = 2e-6, .anchored = false},
       4785,
       15351,
       0x4a7881f2502dd675,
       0xc1fb9b4d747ed35e},
      {"sdct 32 to 0.1 um, free",
       {.block = 32, .max_rms = 1e-7, .redundancy = 2, .anchored = false},
       14554,
       37477,
       0xdbfa529a082a4513,
       0x9c8ae05034cec798},
      {"sdct 64 to 50 um, free",
       {.block = 64, .max_rms = 5e-5, .redundancy = 7, .anchored = false},
       19481,
       19664,
       0xcdbc196a29bd0b6a,
       0x8e1bc767484eb7ae},
      {"sdct integrated, free",
       {.keep = 3, .integrated = true, .anchored = false},
       4968,
       16000,
       0xb34d4d142d245e10,
       0xefabffa6f5a50c0f},
      {"sdct integrated to 1 um, free",
       {.max_rms = 1e-6, .integrated = true, .anchored = false},
       5208,
       17094,
       0xb112b7865b16d115,
       0xaad969b1ea6ad45d},
      {"one axis, free", {.axes = 1, .anchored = false}, 2660, 6305, 0x3aaf3d193c67d2a1, 0x11c57b62d26c2d75},
      {"truncated, free", named("truncated", {.anchored = false}), 5158, 15986, 0xc026a20f6cbaa29f,
       0x2b0de95528ef2712},
      {"truncated to 2 um, free", named("truncated", {.block = 32, .max_rms = 2e-6, .anchored = false}),
       12972, 47936, 0x96f0e4d5921fd43e, 0x9f9a60f779f4eacf},
      {"deadband", named("deadband", {.block = 16, .redundancy = 1, .threshold = 1e-4, .anchored = false}),
       6812, 22237, 0xa9ed2bd570ec3da4, 0x183be48b67142c5d},
      {"deadband to 2 um",
       named("deadband", {.block = 32, .max_rms = 2e-6, .redundancy = 2, .anchored = false}), 24771, 63229,
       0x4583cef70f4ae587, 0x76a87cc93908fcfd},
      {"weber", named("weber", {.block = 16, .redundancy = 1, .threshold = 0.02, .anchored = false}), 7279,
       24079, 0x1cca995b2301d46c, 0x1040d428eecbe5c5},
      {"weber to 2 um", named("weber", {.block = 32, .max_rms = 2e-6, .redundancy = 2, .anchored = false}),
       24778, 63247, 0x789b8263a5d63cee, 0x719b09b33d968aa8},
      {"dpcm", named("dpcm", {.block = 16, .redundancy = 1, .threshold = 0, .anchored = false}), 9054, 31281,
       0x7475bdf1e7d70517, 0xabb7652d1944aad2},
      {"dpcm to 2 um", named("dpcm", {.block = 32, .max_rms = 2e-6, .redundancy = 2, .anchored = false}),
       16278, 40194, 0x1fb42f4979941b1d, 0x534da63d45bbe799},
      {"batched", named("batched", {.block = 16, .redundancy = 1, .threshold = 0, .anchored = false}), 39668,
       154440, 0xfc676ba6d7386c3e, 0x3ab6a2841a34cdad},
      {"batched to 2 um",
       named("batched", {.block = 32, .max_rms = 2e-6, .redundancy = 2, .anchored = false}), 115927, 308680,
       0x8de50853ca636713, 0x7535ff855e2a63b7},
      {"dpcm 64", named("dpcm", {.block = 64, .quantum = 1e-8, .anchored = true}), 50555, 198000,
       0xc41c043e2bf1bc12, 0x0ce12b8978a540ae},
      {"raw", named("raw", {.anchored = true}), 2500, 9800, 0x212d08f3b3181b91, 0x30e5d9abe31b2cd1},
  };
  return rows;
}

TEST(Golden, FixedStreamsTakeExactlyTheseBytes) {
  for (const Golden& row : golden()) {
    const Golden now = measured(row);
    EXPECT_TRUE(now.bytes == row.bytes && now.newest_bits == row.newest_bits && now.packets == row.packets &&
                now.decoded == row.decoded)
        << fmt::format("{}: {} (was {}), {} (was {}), 0x{:016x} (was 0x{:016x}), 0x{:016x} (was 0x{:016x})",
                       row.what, now.bytes, row.bytes, now.newest_bits, row.newest_bits, now.packets,
                       row.packets, now.decoded, row.decoded);
  }
}

}  // namespace
}  // namespace telekerf::codec
