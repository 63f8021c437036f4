// SPDX-License-Identifier: Apache-2.0
// Laws of the transform, the selection and the index code.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>
#include <random>

#include "common/codec/dct.h"
#include "common/codec/selection.h"

namespace telekerf::codec {
namespace {

std::vector<double> noise(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> x(static_cast<std::size_t>(n));
  for (auto& value : x) value = normal(random);
  return x;
}
double energy(const std::vector<double>& x) {
  double sum = 0;
  for (const double value : x) sum += value * value;
  return sum;
}
std::vector<double> transform(const std::vector<double>& x) {
  std::vector<double> c(x.size());
  Dct::of_size(static_cast<int>(x.size())).forward(x, c);
  return c;
}
double dropped(const std::vector<double>& c, IndexSet kept) {
  double sum = 0;
  for (std::size_t k = 0; k < c.size(); ++k) {
    if ((kept >> k & 1) == 0) sum += c[k] * c[k];
  }
  return sum;
}

class EverySize : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dct, EverySize, testing::Range(kMinTransform, kMaxBlock + 1));

TEST_P(EverySize, RoundTripAndParsevalHold) {
  const auto x = noise(GetParam(), 7);
  const auto c = transform(x);
  std::vector<double> back(x.size());
  Dct::of_size(GetParam()).inverse(c, back);
  for (std::size_t n = 0; n < x.size(); ++n) EXPECT_NEAR(back[n], x[n], 1e-12);
  EXPECT_NEAR(energy(c) / energy(x), 1.0, 1e-12);
}

TEST_P(EverySize, AgreesWithTheDefinition) {
  const int size = GetParam();
  const auto x = noise(size, 8);
  const auto c = transform(x);
  for (int k = 0; k < size; ++k) {  // eq. 162
    double sum = 0;
    for (int n = 0; n < size; ++n) {
      sum += x[static_cast<std::size_t>(n)] * std::cos((2 * n + 1) * k * std::numbers::pi / (2 * size));
    }
    sum *= std::sqrt(2.0 / size) * (k == 0 ? std::sqrt(0.5) : 1.0);
    EXPECT_NEAR(c[static_cast<std::size_t>(k)], sum, 1e-12);
  }
}

TEST_P(EverySize, StrongestAreNeverWorseThanTruncation) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto c = transform(noise(GetParam(), seed));
    for (int m = 0; m <= GetParam(); ++m) {
      const auto kept = strongest(c, m);
      ASSERT_EQ(std::popcount(kept), m);
      const IndexSet low = m >= 64 ? ~IndexSet{0} : (IndexSet{1} << m) - 1;
      EXPECT_LE(dropped(c, kept), dropped(c, low)) << "seed " << seed << " m " << m;
    }
  }
}

TEST(Selection, TiesGoToTheLowerIndexAndSignsDoNotMatter) {
  EXPECT_EQ(strongest(std::vector<double>{1, -1, 1, -1}, 2), 0b0011u);
  EXPECT_EQ(strongest(std::vector<double>{1, -3, 2, 0.5}, 2), 0b0110u);
}

TEST(Selection, ErrorOfABlockIsTheEnergyDropped) {
  const auto x = noise(32, 3);
  auto c = transform(x);
  const auto kept = strongest(c, 5);
  const double expected = dropped(c, kept);
  for (std::size_t k = 0; k < c.size(); ++k) {
    if ((kept >> k & 1) == 0) c[k] = 0;
  }
  std::vector<double> back(x.size());
  Dct::of_size(32).inverse(c, back);
  double error = 0;
  for (std::size_t n = 0; n < x.size(); ++n) error += (x[n] - back[n]) * (x[n] - back[n]);
  EXPECT_NEAR(error / expected, 1.0, 1e-12);
}

/// Algorithm 4 as printed: sorts signed values ascending and keeps the low indices at the sorted places.
std::vector<double> algorithm_4_as_printed(const std::vector<double>& c, int m) {
  auto sorted = c;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::size_t> index(c.size());
  for (std::size_t i = 0; i < c.size(); ++i) {
    index[i] = static_cast<std::size_t>(std::find(c.begin(), c.end(), sorted[i]) - c.begin()) + 1;
  }
  std::vector<double> out(c.size());
  for (std::size_t i = 0; i < c.size(); ++i) out[i] = static_cast<int>(index[i]) < m ? sorted[i] : 0.0;
  return out;
}

TEST(Selection, TheErratumOfAlgorithm4IsReal) {
  constexpr int kSize = 16;
  std::vector<double> x(kSize);
  const auto ripple = noise(kSize, 5);
  for (int n = 0; n < kSize; ++n) {
    x[static_cast<std::size_t>(n)] = std::cos((2 * n + 1) * 10.2 * std::numbers::pi / (2 * kSize)) +
                                     0.02 * ripple[static_cast<std::size_t>(n)];
  }
  const auto c = transform(x);
  const auto printed = algorithm_4_as_printed(c, 5);
  double printed_error = 0;
  for (std::size_t k = 0; k < c.size(); ++k) printed_error += (c[k] - printed[k]) * (c[k] - printed[k]);
  EXPECT_GT(printed_error / energy(c), 0.9);
  EXPECT_LT(dropped(c, strongest(c, 5)) / energy(c), 0.05);
}

TEST(IndexCode, IsABijectionAndNeverDearerThanAMask) {
  for (const int n : {4, 7, 10}) {
    for (int m = 0; m <= n; ++m) {
      for (std::uint64_t rank = 0; rank < choose(n, m); ++rank) {
        const auto set = set_of_rank(rank, n, m);
        ASSERT_EQ(std::popcount(set), m);
        ASSERT_EQ(rank_of(set), rank);
      }
      EXPECT_LE(index_set_bits(n, m), n);
    }
  }
  EXPECT_EQ(index_set_bits(32, 4), 16);
  const IndexSet wide = 0xF0F0'1234'8001'FFFFull;
  EXPECT_EQ(set_of_rank(rank_of(wide), 64, std::popcount(wide)), wide);
}

}  // namespace
}  // namespace telekerf::codec
