// SPDX-License-Identifier: Apache-2.0
// Delay laws: quantiles and moments against closed forms, cut at zero, and tables that follow them.
#include "netem/core/delay_distribution.h"
#include "netem/core/delay_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace telekerf::netem {
namespace {

DelayParameters law(DelayDistribution kind, double delay_s, double jitter_s, double shape = 0.0) {
  DelayParameters law;
  law.distribution = kind;
  law.delay_s = delay_s;
  law.jitter_s = jitter_s;
  law.shape = shape;
  return law;
}

double quantile(const DelayParameters& l, double p) { return delay_quantile(l, p, 1.0 - p); }

TEST(DelayDistribution, JitterIsTheStandardDeviationOfEveryLaw) {
  for (const DelayParameters& l :
       {law(DelayDistribution::kUniform, 0.1, 0.01), law(DelayDistribution::kNormal, 0.1, 0.01),
        law(DelayDistribution::kLaplace, 0.3, 0.01), law(DelayDistribution::kGamma, 0.1, 0.01, 2.0),
        law(DelayDistribution::kGamma, 0.1, 0.01, 0.3), law(DelayDistribution::kLognormal, 0.1, 0.01, 0.8),
        law(DelayDistribution::kPareto, 0.1, 0.01, 9.0)}) {
    EXPECT_NEAR(delay_moments(l, 9.0).sd_s, 0.01, 2e-5) << static_cast<int>(l.distribution);
  }
}

TEST(DelayDistribution, ClosedForms) {
  // Gamma(2, 5 ms): mean 10 ms; the median of Gamma(2, 1) is 1.678347.
  const DelayParameters gamma = law(DelayDistribution::kGamma, 0.05, std::sqrt(2.0) * 0.005, 2.0);
  EXPECT_NEAR(delay_moments(gamma).mean_s, 0.060, 1e-6);
  EXPECT_NEAR(quantile(gamma, 0.5), 0.05 + 0.005 * 1.678346990, 1e-9);
  // Exponential: -log(1 - p).
  EXPECT_NEAR(quantile(law(DelayDistribution::kGamma, 0.0, 0.01, 1.0), 0.9), 0.01 * std::log(10.0), 1e-9);
  // Normal, Laplace, uniform about 100 ms.
  EXPECT_NEAR(quantile(law(DelayDistribution::kNormal, 0.1, 0.01), 0.975), 0.1 + 0.01 * 1.959963985, 1e-9);
  EXPECT_NEAR(quantile(law(DelayDistribution::kLaplace, 0.1, 0.01), 0.75),
              0.1 + 0.01 * std::log(2.0) / std::numbers::sqrt2, 1e-8);
  EXPECT_NEAR(quantile(law(DelayDistribution::kUniform, 0.1, 0.01), 1.0), 0.1 + 0.01 * std::numbers::sqrt3,
              1e-9);
  // Lomax with tail index 3: lambda = jitter / sqrt(3/4), median lambda (2^(1/3) - 1).
  EXPECT_NEAR(quantile(law(DelayDistribution::kPareto, 0.0, 0.01, 3.0), 0.5),
              0.01 / std::sqrt(0.75) * (std::cbrt(2.0) - 1.0), 1e-9);
}

TEST(DelayDistribution, ParetoKeepsItsTail) {
  // Halving the tail probability multiplies a far quantile by 2^(1/alpha), however far out.
  const DelayParameters pareto = law(DelayDistribution::kPareto, 0.0, 0.01, 2.5);
  for (double upper = 1e-6; upper > 1e-17; upper /= 10) {
    const double ratio = delay_quantile(pareto, 1.0, upper / 2) / delay_quantile(pareto, 1.0, upper);
    EXPECT_NEAR(ratio, std::pow(2.0, 1 / 2.5), 2e-3) << upper;
  }
  EXPECT_GT(DelayTable(pareto).at(8.0),
            DelayTable(pareto).at(4.0) * 100);  // far beyond 4 standard deviations
}

TEST(DelayDistribution, TheLawCutAtZeroIsTheConditionalOne) {
  // Normal about 0: the half-normal law.
  const DelayParameters half = law(DelayDistribution::kNormal, 0.0, 0.01);
  EXPECT_NEAR(quantile(half, 0.5), 0.01 * 0.674489750, 1e-9);
  EXPECT_NEAR(delay_moments(half).mean_s, 0.01 * std::sqrt(2 / std::numbers::pi), 1e-7);
  for (const DelayDistribution kind :
       {DelayDistribution::kUniform, DelayDistribution::kNormal, DelayDistribution::kLaplace}) {
    const DelayParameters cut = law(kind, 0.005, 0.01);
    EXPECT_NEAR(quantile(cut, 0.0), 0.0, 1e-9);
    const double below = quantile(law(kind, 1.0, 0.01), 0.9) - 0.995;  // the same law without the cut
    const double share_cut = [&] {
      double low = 0, high = 1;
      for (int i = 0; i < 60; ++i) {
        const double p = (low + high) / 2;
        (quantile(law(kind, 1.0, 0.01), p) < 0.995 ? low : high) = p;
      }
      return low;
    }();
    EXPECT_NEAR(quantile(cut, (0.9 - share_cut) / (1 - share_cut)), below, 1e-9) << static_cast<int>(kind);
  }
}

TEST(DelayDistribution, TablesFollowTheirQuantiles) {
  DelayParameters table;
  table.distribution = DelayDistribution::kTable;
  table.delay_s = 0.010;
  table.table_p = {0.0, 0.5, 1.0};
  table.table_s = {0.0, 0.002, 0.010};
  EXPECT_DOUBLE_EQ(quantile(table, 0.25), 0.011);
  EXPECT_DOUBLE_EQ(quantile(table, 0.75), 0.016);
  EXPECT_NEAR(delay_moments(table).mean_s, 0.010 + 0.5 * 0.001 + 0.5 * 0.006, 1e-6);
}

TEST(DelayDistribution, ATablesStepsStaySharp) {
  // 70 % near 10 ms, the rest near 50 ms, next to nothing between: no interpolation may put packets there.
  DelayParameters table;
  table.distribution = DelayDistribution::kTable;
  table.table_p = {0.0, 0.7, 0.7001, 1.0};
  table.table_s = {0.010, 0.012, 0.050, 0.060};
  const DelayTable delays(table);
  const double mean_s = 0.7 * 0.011 + 0.0001 * 0.031 + 0.2999 * 0.055;
  EXPECT_NEAR(delay_moments(table).mean_s, mean_s, 1e-12);
  const double square = 0.7 * (0.01 * 0.01 + 0.01 * 0.012 + 0.012 * 0.012) / 3 +
                        0.0001 * (0.012 * 0.012 + 0.012 * 0.05 + 0.05 * 0.05) / 3 +
                        0.2999 * (0.05 * 0.05 + 0.05 * 0.06 + 0.06 * 0.06) / 3;
  EXPECT_NEAR(delay_moments(table).sd_s, std::sqrt(square - mean_s * mean_s), 1e-12);
  int between = 0;
  constexpr int kScores = 100'000;
  for (int i = 0; i < kScores; ++i) {
    const double z = -3.5 + 7.0 * i / kScores;
    const std::int64_t ns = delays.at(z);
    between += ns > 12'000'000 && ns < 50'000'000;
    EXPECT_NEAR(static_cast<double>(ns), delay_at_normal(table, z) * 1e9, 38e6 * 1e-5 / 1e-4 + 1) << z;
    EXPECT_NEAR(delays.normal_score(ns), z, 1e-3);
  }
  // 1e-4 of the packets are drawn there: at a density of 0.348, z = 0.524 moves by 2.9e-4.
  EXPECT_NEAR(between, kScores * 1e-4 / 0.348 / 7.0, 2.0);
}

TEST(DelayDistribution, DelayTableInterpolatesWithinAMicrosecond) {
  for (const DelayParameters& l :
       {law(DelayDistribution::kUniform, 0.1, 0.01), law(DelayDistribution::kNormal, 0.01, 0.01),
        law(DelayDistribution::kLaplace, 0.1, 0.01), law(DelayDistribution::kGamma, 0.1, 0.01, 2.0),
        law(DelayDistribution::kLognormal, 0.1, 0.01, 0.8),
        law(DelayDistribution::kPareto, 0.1, 0.01, 3.0)}) {
    const DelayTable table(l);
    for (double z = -5; z < 5; z += 0.0137) {
      const double exact_s = delay_at_normal(l, z);
      EXPECT_NEAR(static_cast<double>(table.at(z)) * 1e-9, exact_s,
                  1e-6 + 1e-3 * std::abs(exact_s - l.delay_s))
          << z;
      if (std::abs(z) < 4) {
        EXPECT_NEAR(table.normal_score(table.at(z)), z, 1e-3);
      }
    }
  }
}

}  // namespace
}  // namespace telekerf::netem
