// SPDX-License-Identifier: Apache-2.0
// Random numbers: golden words (a change of them changes every recorded experiment), uniformity,
// independence.
#include "netem/core/random.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "netem/core/delay_distribution.h"
#include "netem/core/delay_table.h"

namespace telekerf::netem {
namespace {

TEST(Random, GoldenWords) {
  const Stream delay({1, 0, Direction::kForward}, Impairment::kDelay);
  const Stream loss({2026, 7, Direction::kBackward}, Impairment::kLoss);
  EXPECT_EQ(delay.draw(0), 1326623584561873245U);
  EXPECT_EQ(delay.draw(1), 9225811281548602488U);
  EXPECT_EQ(loss.draw(123'456'789), 9948991554470210976U);
}

TEST(Random, EveryPartOfTheKeyGivesAnotherStream) {
  const Stream base({1, 0, Direction::kForward}, Impairment::kDelay);
  const Stream others[] = {Stream({2, 0, Direction::kForward}, Impairment::kDelay),
                           Stream({1, 1, Direction::kForward}, Impairment::kDelay),
                           Stream({1, 0, Direction::kBackward}, Impairment::kDelay),
                           Stream({1, 0, Direction::kForward}, Impairment::kLoss)};
  for (const Stream& other : others) {
    int different_bits = 0;
    for (std::uint64_t i = 0; i < 10'000; ++i) different_bits += std::popcount(base.draw(i) ^ other.draw(i));
    EXPECT_NEAR(different_bits / 640'000.0, 0.5, 6 * 0.5 / std::sqrt(640'000.0));
  }
}

TEST(Random, NeighbouringCountersAreUniformAndIndependent) {
  // Chi-square over the pairs (high bits of draw i, high bits of draw i + 1), and over the low bits.
  constexpr int kCells = 1024;
  for (const int shift : {59, 0, 31}) {
    const Stream stream({static_cast<std::uint64_t>(shift), 3, Direction::kForward}, Impairment::kReorder);
    std::array<double, kCells> count{};
    constexpr int kDraws = 1'000'000;
    for (std::uint64_t i = 0; i < kDraws; ++i) {
      count[((stream.draw(i) >> shift) & 31) * 32 + ((stream.draw(i + 1) >> shift) & 31)] += 1;
    }
    double chi_square = 0.0;
    for (const double n : count) chi_square += (n - kDraws / double{kCells}) * (n - kDraws / double{kCells});
    chi_square /= kDraws / double{kCells};
    EXPECT_NEAR(chi_square, kCells - 1, 6 * std::sqrt(2.0 * kCells)) << "shift " << shift;
  }
}

TEST(Random, EveryBitOfTheCounterMovesEveryBitOfTheWord) {
  const Stream stream({9, 9, Direction::kForward}, Impairment::kSlot);
  for (int bit = 0; bit < 64; ++bit) {
    std::array<int, 64> flipped{};
    constexpr int kTries = 2000;
    for (std::uint64_t i = 0; i < kTries; ++i) {
      std::uint64_t change = stream.draw(i * 77) ^ stream.draw((i * 77) ^ (1ULL << bit));
      for (int out = 0; out < 64; ++out, change >>= 1) flipped[out] += change & 1;
    }
    for (int out = 0; out < 64; ++out) {
      EXPECT_NEAR(flipped[out] / double{kTries}, 0.5, 6 * 0.5 / std::sqrt(kTries)) << bit << " -> " << out;
    }
  }
}

TEST(Random, ChancesAtTheirEnds) {
  EXPECT_FALSE(Probability(0.0).happens(0));
  EXPECT_FALSE(Probability(0.0).possible());
  EXPECT_TRUE(Probability(1.0).happens(~0ULL));
  EXPECT_TRUE(Probability(0.5).happens((1ULL << 63) - 1));
  EXPECT_FALSE(Probability(0.5).happens(1ULL << 63));
}

TEST(Random, NormalNumbersHaveTheNormalLaw) {
  const NormalTable& table = NormalTable::instance();
  // Against the error function, from the middle far into both tails.
  for (int octave = 1; octave < 48; ++octave) {
    for (const double part : {1.0, 1.1, 1.37, 1.5, 1.99}) {
      const double upper = std::ldexp(part, -octave - 1);
      const auto word = static_cast<std::uint64_t>(std::ldexp(upper, 64));
      const double z = table.at(word | (1ULL << 63));
      const double expected = 0.5 * std::erfc(z / std::sqrt(2.0));
      EXPECT_NEAR(expected / upper, 1.0, 1e-3) << upper;
      EXPECT_EQ(table.at(word & ~(1ULL << 63)), -z);
    }
  }
  const Stream stream({4, 0, Direction::kForward}, Impairment::kDelay);
  double sum = 0, squares = 0, fourth = 0;
  constexpr int kDraws = 1'000'000;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const double z = table.at(stream.draw(i));
    sum += z;
    squares += z * z;
    fourth += z * z * z * z;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 6 / std::sqrt(kDraws));
  EXPECT_NEAR(squares / kDraws, 1.0, 6 * std::sqrt(2.0 / kDraws));
  EXPECT_NEAR(fourth / kDraws, 3.0, 6 * std::sqrt(96.0 / kDraws));
}

}  // namespace
}  // namespace telekerf::netem
