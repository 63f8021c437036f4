// SPDX-License-Identifier: Apache-2.0
// The offline measure's figures where each of them is known beforehand; files of traces.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/codec/baselines/measure.h"
#include "common/protocol/overhead.h"
#include "common/runtime/startup_error.h"

namespace telekerf::codec {
namespace {

/// Every second sample a quarter above, the others a quarter below whole numbers.
Trace zigzag_trace(std::size_t samples, std::size_t columns = 1) {
  Trace trace{"zigzag", {}, {}, 500.0};
  for (std::size_t c = 0; c < columns; ++c) {
    trace.columns.push_back(std::string("c").append(std::to_string(c)));
    trace.values.emplace_back();
    for (std::size_t n = 0; n < samples; ++n)
      trace.values.back().push_back(5.0 + (n % 2 == 0 ? 0.25 : -0.25));
  }
  return trace;
}

StreamSettings dpcm(int block, int redundancy, bool anchored = false) {
  return with_codec({.block = block, .redundancy = redundancy, .quantum = 1.0, .anchored = anchored}, "dpcm");
}

TEST(Measure, ErrorsOfPositionAndVelocityAreThoseOfRounding) {
  Trace decoded;
  const CodingResult figures = measure(zigzag_trace(67), dpcm(8, 2), {}, &decoded);
  EXPECT_EQ(figures.samples, 64u);
  EXPECT_EQ(figures.packets, 8u);
  EXPECT_EQ(figures.lost, 0u);
  EXPECT_DOUBLE_EQ(figures.rmse, 0.25);
  EXPECT_DOUBLE_EQ(figures.max_error, 0.25);
  EXPECT_DOUBLE_EQ(figures.velocity_rmse, 0.5 * 500.0);
  EXPECT_DOUBLE_EQ(figures.latency_ms, 7.0 * 2.0);
  EXPECT_DOUBLE_EQ(figures.recovery_latency_ms, 8.0 * 2.0 * 2.0);
  EXPECT_DOUBLE_EQ(figures.packets_per_s, 8.0 / (64.0 / 500.0));
  EXPECT_DOUBLE_EQ(figures.raw_wire_bytes_per_s, 500.0 * (kDatagramBytes + 4.0));
  EXPECT_DOUBLE_EQ(figures.wire_bytes_per_s, figures.packets_per_s * figures.frame_bytes);
  EXPECT_EQ(decoded.values[0], std::vector<double>(64, 5.0));
  EXPECT_THROW((void)measure(zigzag_trace(7), dpcm(8, 0)), StartupError);
}

TEST(Measure, AFrameIsAsLongAsThoseOfALap) {
  // In a lap of the demo 116.0 bytes stand around a command's payload
  // (tests/unit/simulation/test_wire_bytes.cpp).
  Trace trace = zigzag_trace(16 * 1000, 3);
  for (auto& column : trace.values)
    for (double& value : column) value *= 1e-3;
  const CodingResult figures =
      measure(trace, with_codec({.block = 16, .redundancy = 1, .quantum = 1e-6, .anchored = true}, "sdct"));
  EXPECT_NEAR(figures.frame_bytes - figures.packet_bytes, 116.0, 1.0);
}

TEST(Measure, BitsAreOfTheBlockAndEachColumn) {
  // Two bits of the button, one of the mode, and 32 a sample, of four columns in two streams.
  const CodingResult figures =
      measure(zigzag_trace(64, 4), with_codec({.block = 8, .redundancy = 1, .anchored = false}, "batched"));
  EXPECT_EQ(figures.packets, 16u);
  EXPECT_DOUBLE_EQ(figures.bits_per_sample, 32.0 + 2.0 * 2.0 / 32.0);
  EXPECT_DOUBLE_EQ(figures.raw_wire_bytes_per_s, 500.0 * (2.0 * kDatagramBytes + 16.0));
}

TEST(Measure, DeadBandEventsAreSentWhenAColumnLeavesItsBand) {
  Trace steps{"steps", {"a", "b"}, {{}, {}}, 100.0};
  for (int n = 0; n < 40; ++n) {
    steps.values[0].push_back(n < 20 ? 1.0 : 2.0);
    steps.values[1].push_back(n < 30 ? 8.0 : 8.5);
  }
  const auto packets = [&](const char* codec, double threshold) {
    const CodingResult figures = measure(
        steps, with_codec({.block = 1, .redundancy = 0, .threshold = threshold, .anchored = false}, codec));
    EXPECT_DOUBLE_EQ(figures.bits_per_sample, 32.0 * static_cast<double>(figures.packets) / 40.0);
    EXPECT_DOUBLE_EQ(figures.packet_bytes, 8.0);
    return figures.packets;
  };
  EXPECT_EQ(packets("deadband", 0.4), 3u);
  EXPECT_EQ(packets("deadband", 0.5), 2u) << "on the band's edge is within";
  EXPECT_EQ(packets("deadband", 1.0), 1u);
  EXPECT_EQ(packets("weber", 0.05), 3u);
  EXPECT_EQ(packets("weber", 0.0625), 2u);
  EXPECT_EQ(packets("weber", 1.0), 1u);
  EXPECT_THROW((void)measure(steps, with_codec({.block = 1, .redundancy = 0, .anchored = false}, "deadband"),
                             {.loss = 0.1}),
               StartupError);
}

TEST(Lose, AsManyInARowAsItsBoundsAllow) {
  EXPECT_NO_THROW((void)lose(9, {.loss = 0.9, .burst = 1e6}));
  EXPECT_NO_THROW((void)lose(9, {.loss = 0.5, .burst = 1}));
  EXPECT_THROW((void)lose(9, {.loss = 0.51, .burst = 1}), StartupError);
  EXPECT_THROW((void)lose(9, {.loss = 0.76, .burst = 3}), StartupError);
  for (const PacketLoss& wrong :
       {PacketLoss{.loss = 0.91}, PacketLoss{.loss = -0.01}, PacketLoss{.burst = 0.99},
        PacketLoss{.burst = 1.1e6}, PacketLoss{.loss = NAN}})
    EXPECT_THROW((void)lose(9, wrong), StartupError);
  const auto none = lose(1000, {.loss = 0.0, .burst = 5});
  EXPECT_EQ(std::count(none.begin(), none.end(), true), 0);
  EXPECT_EQ(lose(500, {.loss = 0.2, .burst = 3, .seed = 8}), lose(500, {.loss = 0.2, .burst = 3, .seed = 8}));
  EXPECT_NE(lose(500, {.loss = 0.2, .burst = 3, .seed = 8}), lose(500, {.loss = 0.2, .burst = 3, .seed = 9}));
}

struct File {
  explicit File(const std::string& text)
      : path(std::filesystem::temp_directory_path() /
             ("telekerf-measure-" + std::to_string(::getpid()) + ".csv")) {
    std::ofstream(path, std::ios::binary) << text;
  }
  ~File() { std::filesystem::remove(path); }
  std::filesystem::path path;
};

TEST(TraceFile, ColumnsMayBeParted) {
  using Columns = std::vector<std::string>;
  const auto read = [](const std::string& text, const Columns& wanted = {}) {
    const File file(text);
    return read_trace(file.path, 100.0, wanted);
  };
  const Trace bare = read("# a comment\n1, 2 ;3\t4\r\n\r\n\n5,6,7,-8e1\r\n");
  EXPECT_EQ(bare.columns, (Columns{"c1", "c2", "c3", "c4"}));
  EXPECT_EQ(bare.values, (std::vector<std::vector<double>>{{1, 5}, {2, 6}, {3, 7}, {4, -80}}));
  const Trace named = read("x m, y\n1,2\n3,4\n", {"y", "x m"});
  EXPECT_EQ(named.values, (std::vector<std::vector<double>>{{2, 4}, {1, 3}}));
  EXPECT_EQ(named.rate_hz, 100.0);
  for (const char* wrong : {"1,2\n3\n", "1,2\n3,4,5\n", "1,x\n2,3\n", "a,b\n1,\n", "", "# only\n",
                            "1,2\n3,1e39\n", "1,2\n3,nan\n"})
    EXPECT_THROW((void)read(wrong), StartupError) << wrong;
  try {
    (void)read("1,2\n3\n");
  } catch (const StartupError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("line 2: 1 cells where the first line has 2"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace telekerf::codec
