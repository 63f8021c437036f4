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
      {"sdct 16, anchored", {.anchored = true}, 4446, 12154, 0xb506d9a71510e99c, 0xdd87ddb4a953b9dd},
      {"sdct 4, anchored",
       {.block = 4, .redundancy = 0, .anchored = true},
       1960,
       6322,
       0x9fc837da3f60d8fe,
       0x04d165048c325652},
      {"sdct 33, anchored",
       {.block = 33, .keep = 9, .redundancy = 2, .quantum = 1e-7, .anchored = true},
       11879,
       26825,
       0xdc30fa7858135488,
       0x95459d0ebbe358b3},
      {"sdct 64, anchored",
       {.block = 64, .keep = 20, .redundancy = 3, .anchored = true},
       20817,
       38004,
       0x4007563034f48dac,
       0xee4cab1eec62a347},
      {"sdct 16 to 2 um, anchored",
       {.max_rms = 2e-6, .anchored = true},
       4401,
       12185,
       0x681c26fa1305b97e,
       0x5a28805d66515676},
      {"sdct 32 to 0.1 um, anchored",
       {.block = 32, .max_rms = 1e-7, .redundancy = 2, .anchored = true},
       14215,
       33523,
       0x01c1019dac98a5f2,
       0x1fc1310d7141fa22},
      {"sdct 64 to 50 um, anchored",
       {.block = 64, .max_rms = 5e-5, .redundancy = 7, .anchored = true},
       20045,
       17941,
       0x56d62ab04e1c4c8b,
       0x577fd1a3a88c6ce1},
      {"sdct integrated, anchored",
       {.keep = 3, .integrated = true, .anchored = true},
       4864,
       13201,
       0x25aa8ab6c4d5ed34,
       0x33a619c9a7aff555},
      {"sdct integrated to 1 um, anchored",
       {.max_rms = 1e-6, .integrated = true, .anchored = true},
       4733,
       13469,
       0xd2b98f8f7c67d929,
       0x6664bee9b9e7fef4},
      {"one axis, anchored",
       {.axes = 1, .anchored = true},
       2315,
       4308,
       0x90e23a5155ab9516,
       0xbee8d8e372803534},
      {"truncated, anchored", named("truncated", {.anchored = true}), 5052, 15986, 0x7d8476f365752ef3,
       0x2b0de95528ef2712},
      {"truncated to 2 um, anchored", named("truncated", {.block = 32, .max_rms = 2e-6, .anchored = true}),
       12806, 47936, 0x99619769107a166c, 0x9f9a60f779f4eacf},
      {"sdct 16, free", {.anchored = false}, 4942, 16679, 0x9053e3df8ee8d209, 0xb3cbb27cad356281},
      {"sdct 4, free",
       {.block = 4, .redundancy = 0, .anchored = false},
       2430,
       10118,
       0x19e8fbb9b635e294,
       0x351c32a66ea8b9b6},
      {"sdct 33, free",
       {.block = 33, .keep = 9, .redundancy = 2, .quantum = 1e-7, .anchored = false},
       12647,
       32912,
       0x15df8bdfcd5a73da,
       0x3915657b0971511a},
      {"sdct 64, free",
       {.block = 64, .keep = 20, .redundancy = 3, .anchored = false},
       20061,
       40079,
       0x9478a39aeb7bc1ab,
       0x2a025b703a8ade8f},
      {"sdct 16 to 2 um, free",
       {.max_rms = 2e-6, .anchored = false},
       4669,
       15326,
       0x73b85dba05401e28,
       0x7e1a50cf826d9ff7},
      {"sdct 32 to 0.1 um, free",
       {.block = 32, .max_rms = 1e-7, .redundancy = 2, .anchored = false},
       14389,
       37399,
       0xa38e2028da725cf7,
       0x6ede09aa3a3b60bc},
      {"sdct 64 to 50 um, free",
       {.block = 64, .max_rms = 5e-5, .redundancy = 7, .anchored = false},
       19384,
       19668,
       0xc70856e4317b2dfd,
       0x6dbbc3f6548a8496},
      {"sdct integrated, free",
       {.keep = 3, .integrated = true, .anchored = false},
       4969,
       16349,
       0x38b601d0739e1aee,
       0x6f26f0bb1cf6a958},
      {"sdct integrated to 1 um, free",
       {.max_rms = 1e-6, .integrated = true, .anchored = false},
       5088,
       17078,
       0x722c76eb18b74739,
       0xcaf33750f5c12c7f},
      {"one axis, free", {.axes = 1, .anchored = false}, 2590, 6305, 0x049051b6a7bef1be, 0x11c57b62d26c2d75},
      {"truncated, free", named("truncated", {.anchored = false}), 5052, 15986, 0x6ad79dcc24db82df,
       0x2b0de95528ef2712},
      {"truncated to 2 um, free", named("truncated", {.block = 32, .max_rms = 2e-6, .anchored = false}),
       12806, 47936, 0xaf9a464a1d16f1a8, 0x9f9a60f779f4eacf},
      {"deadband", named("deadband", {.block = 16, .redundancy = 1, .threshold = 1e-4, .anchored = false}),
       6703, 22237, 0xdd0ab505c388e962, 0x183be48b67142c5d},
      {"deadband to 2 um",
       named("deadband", {.block = 32, .max_rms = 2e-6, .redundancy = 2, .anchored = false}), 24624, 63229,
       0x348ed38a8d45d616, 0x76a87cc93908fcfd},
      {"weber", named("weber", {.block = 16, .redundancy = 1, .threshold = 0.02, .anchored = false}), 7172,
       24079, 0x6e0dba6eb9be03f6, 0x1040d428eecbe5c5},
      {"weber to 2 um", named("weber", {.block = 32, .max_rms = 2e-6, .redundancy = 2, .anchored = false}),
       24631, 63247, 0x49ce965bd7cf3c4b, 0x719b09b33d968aa8},
      {"dpcm", named("dpcm", {.block = 16, .redundancy = 1, .threshold = 0, .anchored = false}), 8937, 31281,
       0xc51567afe5b3b46c, 0xabb7652d1944aad2},
      {"dpcm to 2 um", named("dpcm", {.block = 32, .max_rms = 2e-6, .redundancy = 2, .anchored = false}),
       16128, 40194, 0x8ced930db90952e6, 0x534da63d45bbe799},
      {"batched", named("batched", {.block = 16, .redundancy = 1, .threshold = 0, .anchored = false}), 39568,
       154440, 0x523069bae722f763, 0x3ab6a2841a34cdad},
      {"batched to 2 um",
       named("batched", {.block = 32, .max_rms = 2e-6, .redundancy = 2, .anchored = false}), 115728, 308680,
       0xc382dddf8ac5cf79, 0x7535ff855e2a63b7},
      {"dpcm 64", named("dpcm", {.block = 64, .quantum = 1e-8, .anchored = true}), 50446, 198000,
       0xd4490fdc8039426f, 0x0ce12b8978a540ae},
      {"raw", named("raw", {.anchored = true}), 2400, 9800, 0x32665a00620fcb42, 0x30e5d9abe31b2cd1},
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
