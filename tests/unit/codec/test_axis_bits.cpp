// SPDX-License-Identifier: Apache-2.0
// What an axis' bits may say, and what no encoder writes: the last value within each bound and the next.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "common/codec/axis_bits.h"
#include "common/codec/bits.h"

namespace telekerf::codec {
namespace {

constexpr int kBlock = 8;

struct Known {
  AxisContext context;
  int exponent = 0;
};
Known known(const std::function<void(AxisContext&)>& change = {}) {
  Known out;
  out.context.model = {.count = 0, .step_offset = 0, .level_order = 0, .value_order = 0};
  if (change) change(out.context);
  return out;
}

/// Whether an axis reads from these bits, all of them and no more.
bool reads(const Known& known, const std::function<void(BitWriter&)>& write) {
  std::vector<std::uint8_t> bytes(256, 0);
  BitWriter writer(bytes);
  write(writer);
  EXPECT_FALSE(writer.overflowed());
  const std::size_t written = writer.position();
  BitReader in(bytes);
  AxisCode code;
  std::array<double, kBlock> samples{};
  const bool read =
      read_axis(in, code, known.context, Grid(kBlock, known.exponent), Dct::of_size(kBlock), samples);
  if (read) {
    (void)in.bits(static_cast<int>(8 * bytes.size() - written) % 64);
    for (std::size_t words = (8 * bytes.size() - written) / 64; words > 0; --words) (void)in.bits(64);
    EXPECT_TRUE(!in.truncated() && in.at_clean_end()) << "more or fewer bits than these were read";
  }
  return read;
}

// Modes of a free stream: the usual one is a single bit, the others count up behind a one.
void intra(BitWriter& out) { out.bits(0, 1); }
void named_intra(BitWriter& out) { out.bits(0b10, 2); }
void curve(BitWriter& out) { out.bits(0b1100, 4); }
void line(BitWriter& out) { out.bits(0b11100, 5); }
void run_length(BitWriter& out) { out.bits(0b11110, 5); }
void hold(BitWriter& out) { out.bits(0b1111110, 7); }

TEST(AxisBits, CountsOfCoefficientsReachFromNoneToTheBlock) {
  const auto with_count = [](int count) {
    return reads(known(), [&](BitWriter& out) {
      intra(out);
      out.signed_golomb(count, 0);
      for (int k = 0; k < count; ++k) out.golomb(0, 0);
    });
  };
  EXPECT_TRUE(with_count(0));
  EXPECT_TRUE(with_count(kBlock));
  EXPECT_FALSE(with_count(kBlock + 1));
  EXPECT_FALSE(with_count(-1));
}

TEST(AxisBits, RanksReachToTheLastSet) {
  const auto with_rank = [](std::uint64_t rank) {  // 28 pairs of 8, in five bits
    return reads(known(), [&](BitWriter& out) {
      named_intra(out);
      out.signed_golomb(2, 0);
      out.bits(rank, 5);
      out.golomb(0, 0);
      out.golomb(0, 0);
    });
  };
  EXPECT_TRUE(with_rank(0));
  EXPECT_TRUE(with_rank(27));
  EXPECT_FALSE(with_rank(28));
  EXPECT_FALSE(with_rank(31));
}

TEST(AxisBits, HoldingWantsATrendToHold) {
  const auto body = [](BitWriter& out) { out.signed_golomb(0, 0); };
  EXPECT_FALSE(reads(known(), [&](BitWriter& out) { hold(out), body(out); }));
  EXPECT_TRUE(reads(known([](AxisContext& c) { c.anchored = true; }), [&](BitWriter& out) {
    out.bits(0b11100, 5);  // in an anchored stream it is the third
    body(out);
  }));
}

TEST(AxisBits, ValuesAndParametersKeepTheirBounds) {
  const auto with_value = [](std::int64_t value) {
    Known fine = known();
    fine.exponent = -160;
    return reads(fine, [&](BitWriter& out) {
      intra(out);
      out.signed_golomb(1, 0);
      out.signed_golomb(value, 0);
    });
  };
  EXPECT_TRUE(with_value(kMaxValue));
  EXPECT_TRUE(with_value(-kMaxValue));
  EXPECT_FALSE(with_value(kMaxValue + 1));
  EXPECT_FALSE(with_value(-kMaxValue - 1));
  const auto with_curve = [](std::int64_t bend, std::int64_t slope) {
    return reads(known(), [&](BitWriter& out) {
      curve(out);
      out.signed_golomb(0, 0);
      out.signed_golomb(bend, 4);
      out.signed_golomb(slope, 3);
    });
  };
  EXPECT_TRUE(with_curve(kMaxParameter, 2 * kMaxParameter));
  EXPECT_TRUE(with_curve(-kMaxParameter, -2 * kMaxParameter));
  EXPECT_FALSE(with_curve(kMaxParameter + 1, 0));
  EXPECT_FALSE(with_curve(-kMaxParameter - 1, 0));
  EXPECT_FALSE(with_curve(0, 2 * kMaxParameter + 1));
  EXPECT_FALSE(with_curve(0, -2 * kMaxParameter - 1));
  EXPECT_TRUE(reads(known(), [](BitWriter& out) {
    line(out);
    out.signed_golomb(0, 0);
    out.signed_golomb(5, 3);
  }));
  // A copy's level, told from a neighbour at zero.
  const auto with_level = [](std::int64_t level) {
    return reads(known([](AxisContext& c) { c.anchored = true, c.newest = false; }), [&](BitWriter& out) {
      out.bits(0b1100, 4);  // a line: the second of the anchored modes
      out.signed_golomb(0, 0);
      out.signed_golomb(0, 2);
      out.signed_golomb(level, 2);
    });
  };
  EXPECT_TRUE(with_level(2 * kMaxParameter));
  EXPECT_FALSE(with_level(2 * kMaxParameter + 1));
  EXPECT_FALSE(with_level(-2 * kMaxParameter - 1));
}

TEST(AxisBits, StepsOfAnAdaptiveStreamReachFromTheFinestToTheCoarsest) {
  const auto with_offset = [](int offset) {
    Known adaptive = known([](AxisContext& c) { c.adaptive = true, c.model.step_offset = 9; });
    adaptive.exponent = -kMaxQuantumExponent;
    return reads(adaptive, [&](BitWriter& out) {
      intra(out);
      out.signed_golomb(offset - 9, 0);
      out.signed_golomb(0, 0);
    });
  };
  EXPECT_TRUE(with_offset(0));
  EXPECT_TRUE(with_offset(kMaxStepOffset));
  EXPECT_FALSE(with_offset(-1));
  EXPECT_FALSE(with_offset(kMaxStepOffset + 1));
}

TEST(AxisBits, SamplesKeepTheirMagnitude) {
  // The mean of eight samples is the level coefficient over sqrt 8; quanta of 2^63 reach 2e30 below
  // kMaxValue.
  const auto with_level = [](std::int64_t value) {
    Known coarse = known();
    coarse.exponent = 252;
    return reads(coarse, [&](BitWriter& out) {
      intra(out);
      out.signed_golomb(1, 0);
      out.signed_golomb(value, 0);
    });
  };
  const double most = 2.0 * kMaxMagnitude * std::sqrt(8.0) / 0x1p63;
  EXPECT_TRUE(with_level(static_cast<std::int64_t>(0.999999 * most)));
  EXPECT_FALSE(with_level(static_cast<std::int64_t>(1.000001 * most)));
  const auto first_of_run = [](std::int64_t first) {
    return reads(known(), [&](BitWriter& out) {
      run_length(out);
      out.golomb(0, 1);
      out.signed_golomb(first, 0);
    });
  };
  EXPECT_TRUE(first_of_run(kMaxParameter));
  EXPECT_TRUE(first_of_run(-kMaxParameter));
  EXPECT_FALSE(first_of_run(kMaxParameter + 1));
  EXPECT_FALSE(first_of_run(-kMaxParameter - 1));
}

}  // namespace
}  // namespace telekerf::codec
