// SPDX-License-Identifier: Apache-2.0
// Loss, copies, concealment and the offline measure.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "common/codec/baselines/measure.h"
#include "common/codec/decoder.h"
#include "common/codec/encoder.h"
#include "common/protocol/overhead.h"
#include "common/runtime/startup_error.h"

namespace telekerf::codec {
namespace {

Trace wavy(std::size_t samples, std::size_t columns = 3) {
  Trace trace{"wavy", {}, {}, 1000.0};
  std::mt19937 random(4);
  for (std::size_t c = 0; c < columns; ++c) {
    trace.columns.push_back(std::string("c").append(std::to_string(c)));
    std::vector<double> x(samples);
    for (std::size_t n = 0; n < samples; ++n) {
      const auto t = 1e-3 * static_cast<double>(n);
      x[n] = 0.01 * std::sin(3 * t + static_cast<double>(c)) + 4e-5 * std::sin(55 * t) +
             1e-9 * static_cast<double>(random() % 1000);
    }
    trace.values.push_back(x);
  }
  return trace;
}

std::size_t longest_burst(const std::vector<bool>& lost) {
  std::size_t longest = 0, run = 0;
  for (const bool gone : lost) {
    run = gone ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

TEST(Loss, WithAsManyCopiesAsABurstIsLongNothingChanges) {
  const auto trace = wavy(std::size_t{16} * 400);
  for (const char* name : {"sdct", "batched", "truncated", "dpcm", "deadband"}) {
    for (const bool anchored : {true, false}) {
      for (const int redundancy : {1, 2, 4}) {
        auto settings = with_codec({.redundancy = redundancy, .threshold = 1e-5, .anchored = anchored}, name);
        Trace clean, lossy;
        measure(trace, settings, {}, &clean);
        PacketLoss link{.loss = 0.1, .burst = 1.0 + 0.2 * redundancy, .seed = 1};
        // A seed whose bursts are short enough, the first and last packets among those received.
        auto lost = lose(400, link);
        while (static_cast<int>(longest_burst(lost)) > redundancy || lost.front() || lost.back()) {
          ++link.seed;
          lost = lose(400, link);
        }
        const auto figures = measure(trace, settings, link, &lossy);
        EXPECT_GT(figures.lost, 10u);
        EXPECT_EQ(figures.concealed_samples, 0u);
        EXPECT_EQ(clean.values, lossy.values) << name << " R " << redundancy << " seed " << link.seed;
      }
    }
  }
}

TEST(Loss, WithoutCopiesWhatIsLostIsConcealedAndCounted) {
  const auto trace = wavy(std::size_t{16} * 400);
  const auto figures = measure(trace, {.redundancy = 0}, {.loss = 0.05, .seed = 3});
  EXPECT_EQ(figures.concealed_samples, 16 * figures.lost);
  EXPECT_LT(figures.rmse, 1e-4);  // holding still instead would be off by more than a millimetre in places
}

TEST(Loss, SharesAndBurstsAreAsAsked) {
  const auto lost = lose(200'000, {.loss = 0.05, .burst = 4, .seed = 9});
  std::size_t count = 0, bursts = 0;
  for (std::size_t i = 0; i < lost.size(); ++i) {
    count += lost[i];
    bursts += lost[i] && (i == 0 || !lost[i - 1]);
  }
  EXPECT_NEAR(static_cast<double>(count) / 200'000, 0.05, 0.003);
  EXPECT_NEAR(static_cast<double>(count) / static_cast<double>(bursts), 4.0, 0.2);
  EXPECT_THROW(lose(10, {.loss = 1.5}), StartupError);
  EXPECT_THROW(lose(10, {.burst = 0}), StartupError);
}

TEST(Concealment, APositionMovesOnAndComesToRestAForceIsHeld) {
  for (const bool anchored : {true, false}) {
    BlockEncoder encoder({.anchored = anchored});
    BlockDecoder decoder;
    EXPECT_EQ(decoder.conceal(), nullptr);
    std::vector<Vec3> ramp(16);
    for (int n = 0; n < 16; ++n) ramp[static_cast<std::size_t>(n)] = Vec3(1e-5 * n, 0, 0);
    std::vector<std::uint8_t> packet(512);
    const Trend trend{Vec3::Zero(), Vec3(anchored ? 1e-5 : 0.0, 0, 0)};
    const auto size = encoder.encode(ramp, 0xFFFF, trend, packet);
    ASSERT_TRUE(decoder.decode(std::span(packet).first(*size), trend));
    double last = encoder.decoded()[15].x();
    for (int block = 0; block < 20; ++block) {
      const auto* made_up = decoder.conceal();
      ASSERT_NE(made_up, nullptr);
      EXPECT_TRUE(made_up->concealed);
      EXPECT_EQ(made_up->blocks_newest_first[0].button, 0u);  // no beam on made-up motion
      for (const auto& sample : made_up->blocks_newest_first[0].samples) {
        EXPECT_GE(sample.x(), last);
        EXPECT_LE(sample.x() - last, 1.1e-5);
        EXPECT_TRUE(anchored || sample.x() == last);
        last = sample.x();
      }
    }
    EXPECT_NEAR(last, anchored ? 31e-5 : 15e-5, 1e-5);  // one block's length further, then rest
    EXPECT_EQ(decoder.concealed(), 20u);
  }
}

TEST(Measure, CountsEveryByteAndAnyNumberOfColumns) {
  const auto trace = wavy(16 * 100 + 7, 4);
  const auto figures = measure(trace, with_codec({.redundancy = 0, .anchored = false}, "batched"));
  EXPECT_EQ(figures.samples, 1600u);
  EXPECT_EQ(figures.packets, 200u);  // four columns are two streams
  EXPECT_NEAR(figures.bits_per_sample, 32.0, 0.2);
  EXPECT_NEAR(figures.wire_bytes_per_s, figures.packets_per_s * figures.frame_bytes, 1e-6);
  EXPECT_GT(figures.frame_bytes, figures.packet_bytes + 111.0);
  EXPECT_LT(figures.frame_bytes, figures.packet_bytes + 123.0);  // the sets of the first 24 blocks among them
  EXPECT_DOUBLE_EQ(figures.raw_wire_bytes_per_s, 1000.0 * (2 * kDatagramBytes + 16));
  EXPECT_DOUBLE_EQ(figures.latency_ms, 15.0);
  EXPECT_LT(figures.rmse, 1e-9);
}

TEST(Measure, RefusedBlocksAreCountedAndTheRestIsFine) {
  auto trace = wavy(1600, 1);
  trace.values[0][100] = std::nan("");
  trace.values[0][500] = 1e300;
  const auto figures = measure(trace, {.redundancy = 1, .anchored = false});
  EXPECT_EQ(figures.refused_blocks, 2u);
  EXPECT_LT(figures.max_error, 1e-5);
}

TEST(Measure, DeadBandStreamsStayWithinTheirBand) {
  const auto trace = wavy(3000);
  for (const int block : {1, 16}) {
    const StreamSettings settings{
        .block = block, .redundancy = 0, .quantum = 1e-8, .threshold = 1e-4, .anchored = false};
    const auto figures = measure(trace, with_codec(settings, "deadband"));
    EXPECT_LE(figures.max_error, 1e-4 + 1e-8);
    EXPECT_GT(figures.max_error, 5e-5);
    EXPECT_TRUE(block > 1 || figures.packets < 2000u) << figures.packets;
  }
}

TEST(TraceFile, ReadsWhatItWroteAndRefusesNonsense) {
  const auto file = std::filesystem::temp_directory_path() / "telekerf-test-trace.csv";
  const auto trace = wavy(50);
  write_trace(file, trace);
  const auto back = read_trace(file, 1000.0);
  EXPECT_EQ(back.columns, trace.columns);
  EXPECT_EQ(back.values, trace.values);
  EXPECT_EQ(read_trace(file, 1000.0, {"c2"}).values[0], trace.values[2]);
  EXPECT_THROW(read_trace(file, 1000.0, {"c9"}), StartupError);
  std::ofstream(file) << "1,2\n3,four\n";
  try {
    (void)read_trace(file, 1000.0);
    FAIL();
  } catch (const StartupError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("line 2: 'four' is not a number"), std::string::npos);
  }
  std::ofstream(file) << "a,b\n";
  EXPECT_THROW(read_trace(file, 1000.0), StartupError);
  std::filesystem::remove(file);
  EXPECT_THROW(read_trace(file, 1000.0), StartupError);
}

}  // namespace
}  // namespace telekerf::codec
