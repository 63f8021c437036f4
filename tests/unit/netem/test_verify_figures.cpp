// SPDX-License-Identifier: Apache-2.0
// The figures that verify judges by, against closed forms, and its whole reports as they are.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "netem/verify/bounds.h"
#include "netem/verify/verify.h"
#include "tests/unit/netem/recorded.h"

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

TEST(Bounds, BernsteinsInequalityHoldsWithEquality) {
  for (const double n : {100.0, 1e5}) {
    for (const double variance : {0.01, 0.25, 3.0}) {
      for (const double range : {1.0, 7.0}) {
        // Of independent ones: n t^2 / (2 (v + r t / 3)); of a chain: n t^2 / (2 (v (1 + m) / (1 - m) + 5 r t
        // / (1 - m))).
        const double t = bernstein(n, variance, range, 0.0);
        EXPECT_NEAR(n * t * t / (2.0 * (variance + range * t / 3.0)), kLogAlarm, 1e-9);
        const double u = bernstein(n, variance, range, 0.6);
        EXPECT_NEAR(n * u * u / (2.0 * (variance * 4.0 + 12.5 * range * u)), kLogAlarm, 1e-9);
      }
    }
  }
}

TEST(Bounds, OvertakingHasItsClosedForms) {
  const auto tail = [](double x) { return 0.5 * std::erfc(x / std::numbers::sqrt2); };
  for (const double interval_s : {0.001, 0.01, 0.03}) {
    for (const double rho : {0.0, 0.5, 0.9}) {
      DelayParameters normal = law(DelayDistribution::kNormal, 0.2, 0.01);
      normal.correlation_s = rho > 0 ? -interval_s / std::log(rho) : 0.0;
      EXPECT_NEAR(overtaking_probability(normal, interval_s),
                  tail(interval_s / (0.01 * std::sqrt(2.0 * (1.0 - rho)))), 1e-6)
          << interval_s << " " << rho;
    }
    // The difference of two exponential waits is a Laplace law.
    EXPECT_NEAR(overtaking_probability(law(DelayDistribution::kGamma, 0.1, 0.01, 1.0), interval_s),
                0.5 * std::exp(-interval_s / 0.01), 1e-4);
  }
  EXPECT_EQ(overtaking_probability(law(DelayDistribution::kConstant, 0.1, 0.0), 0.001), 0.0);
  DelayParameters table;
  table.distribution = DelayDistribution::kTable;
  table.table_p = {0.0, 1.0};
  table.table_s = {0.0, 0.010};  // uniform: (1 - t)^2 / 2
  EXPECT_NEAR(overtaking_probability(table, 0.004), 0.5 * 0.6 * 0.6, 1e-3);
}

TEST(Bounds, MemoryOfFourStatesIsTheirSecondEigenvalue) {
  LossParameters four;
  four.model = LossModel::kFourState;
  four.p13 = 0.05, four.p31 = 0.2, four.p32 = 0.3, four.p23 = 0.4, four.p14 = 0.03;
  const LossChain chain = loss_chain(four);
  // The characteristic polynomial of the transition matrix vanishes there, and at no larger number below 1.
  const auto determinant = [&](double lambda) {
    double a[4][4];
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) a[i][j] = chain.to[i][j] - (i == j ? lambda : 0.0);
    }
    double product = 1.0;
    for (int k = 0; k < 4; ++k) {
      product *= a[k][k];
      for (int i = k + 1; i < 4; ++i) {
        const double factor = a[i][k] / a[k][k];
        for (int j = k; j < 4; ++j) a[i][j] -= factor * a[k][j];
      }
    }
    return product;
  };
  const double memory = chain_memory(chain);
  EXPECT_LT(determinant(memory - 1e-6) * determinant(memory + 1e-6), 0.0) << memory;
  const double sign = determinant(0.999);
  for (double lambda = memory + 1e-4; lambda < 0.999; lambda += 1e-3)
    EXPECT_GT(determinant(lambda) * sign, 0.0);
  LossParameters bernoulli;
  bernoulli.model = LossModel::kBernoulli;
  bernoulli.loss = 0.3;
  EXPECT_EQ(chain_memory(loss_chain(bernoulli)), 0.0);
}

/// lost - burst x begins of independent losses: variance p (1 + b^2 ...) by hand.
TEST(Bounds, BurstVarianceOfIndependentLosses) {
  LossParameters law;
  law.model = LossModel::kBernoulli;
  law.loss = 0.25;
  // Bursts of independent losses are geometric with mean 4/3: they begin at rate 3/16, each with variance
  // 4/9.
  EXPECT_NEAR(burst_variance(loss_chain(law)), 3.0 / 16.0 * 4.0 / 9.0, 1e-9);
}

TEST(DelayDistribution, FourthMomentsAndCutMomentsHaveTheirClosedForms) {
  const double s4 = std::pow(0.01, 4);
  EXPECT_NEAR(delay_moments(law(DelayDistribution::kNormal, 0.2, 0.01), 9.0).fourth_s4 / s4, 3.0, 1e-6);
  EXPECT_NEAR(delay_moments(law(DelayDistribution::kUniform, 0.2, 0.01), 9.0).fourth_s4 / s4, 1.8, 1e-4);
  EXPECT_NEAR(delay_moments(law(DelayDistribution::kLaplace, 0.5, 0.01), 9.0).fourth_s4 / s4, 6.0, 1e-3);
  // Normal scores beyond +-1 carry the value at +-1.
  const Moments cut = delay_moments(law(DelayDistribution::kNormal, 0.2, 0.01), 1.0);
  const double density = std::exp(-0.5) / std::sqrt(2.0 * std::numbers::pi);
  EXPECT_NEAR(cut.mean_s, 0.2, 1e-12);
  EXPECT_NEAR(cut.sd_s * cut.sd_s / 1e-4, 1.0 - 2.0 * density, 1e-6);
  // Log-normal: mean exp(s^2 / 2) over its deviation sqrt(exp(s^2) (exp(s^2) - 1)), at median 1.
  const double e = std::exp(0.64);
  EXPECT_NEAR(delay_moments(law(DelayDistribution::kLognormal, 0.1, 0.01, 0.8), 9.0).mean_s,
              0.1 + 0.01 * std::sqrt(e) / std::sqrt(e * (e - 1.0)), 1e-7);
  // Gamma about its floor: mean sqrt(k) deviations; Lomax: mean 1 / (a - 1).
  EXPECT_NEAR(delay_moments(law(DelayDistribution::kGamma, 0.1, 0.01, 3.0), 9.0).mean_s,
              0.1 + 0.01 * std::sqrt(3.0), 1e-7);
  EXPECT_NEAR(delay_moments(law(DelayDistribution::kPareto, 0.1, 0.01, 9.0), 9.0).mean_s,
              0.1 + 0.01 / std::sqrt(9.0 / 7.0), 1e-6);
}

struct Golden {
  const char* keys;
  std::uint64_t report;
};

const Golden kReports[] = {
    {"delay_ms = 20\njitter_ms = 5\ndistribution = \"gamma\"\nshape = 2\ncorrelation_ms = 1.442695\norder = "
     "\"free\"",
     17420145029621540287U},
    {"delay_ms = 20\njitter_ms = 5\ndistribution = \"laplace\"\nloss_model = \"gilbert-elliott\"\nloss = "
     "0.1\n"
     "loss_burst_packets = 5",
     8860259402882279208U},
    {"delay_ms = 20\ndistribution = \"table\"\ntable_p = [0, 0.5, 1]\ntable_ms = [1, 2, 9]\n"
     "loss_model = \"four-state\"\np13 = 0.05\np31 = 0.2\np32 = 0.3\np23 = 0.4\np14 = 0.03",
     10865070020492669978U},
    {"delay_ms = 20\norder = \"reorder\"\nreorder = 0.2\nreorder_gap = 4\nduplicate = 0.1\ncorrupt = 0.2",
     14405910129931135173U},
    {"delay_ms = 4\nrate_kbit_per_s = 900\nqueue_bytes = 3000\nloss = 0.1", 18418663796648070897U},
    {"delay_ms = 3.3\nslot_ms = 5\nslot_jitter_ms = 1\nslot_packets = 6\nloss = 0.1\ntcp_like = true\nrto_ms "
     "= 50",
     14440974234150645338U},
    {"delay_ms = 4\n[[stage]]\nfrom_s = 2\n[stage.both]\ndelay_ms = 9\n[[event]]\nfirst_s = 0.5\nevery_s = "
     "1\n"
     "duration_ms = 100\nadd_delay_ms = [5, 40]\nloss = 0.3\n[[event]]\nfirst_s = 0.7\nevery_s = "
     "2\nduration_ms = 150\n"
     "add_delay_ms = [1, 2]\n",
     14255498386656765113U},
};

TEST(Verify, ReportsAreTheseFigures) {
  for (const Golden& golden : kReports) {
    const DirectionProfile profile = parse_profile(std::string("[both]\n") + golden.keys, "test").forward;
    Traffic traffic;
    traffic.packets = 20'000;
    traffic.seed = 5;
    std::string text;
    for (const auto& report : verify_direction(profile, profile, Direction::kForward, traffic)) {
      text += fmt::format("from {:g} s\n", report.from_s);
      for (const Check& check : report.checks)
        text += fmt::format("{} {}: {:.5g} of {:.5g} within {:.5g} {:.5g}{}\n", check.name, check.unit,
                            check.measured, check.nominal, check.low, check.high,
                            check.judged ? "" : ", not judged");
    }
    EXPECT_EQ(fingerprint(text), golden.report) << golden.keys << "\n" << text;
  }
}

}  // namespace
}  // namespace telekerf::netem
