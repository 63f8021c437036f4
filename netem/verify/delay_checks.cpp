// SPDX-License-Identifier: Apache-2.0
#include "netem/verify/delay_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "netem/core/delay_table.h"
#include "netem/verify/bounds.h"

namespace telekerf::netem {
namespace {

/// Means and deviations are taken within these normal scores of the nominal law.
constexpr double kWinsorScore = 3.5;

void check_quantiles(const DelayParameters& law, double rho, std::vector<std::int64_t> drawn_ns,
                     Checks& checks) {
  std::sort(drawn_ns.begin(), drawn_ns.end());
  const auto n = static_cast<double>(drawn_ns.size());
  for (const double p : {0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 0.999}) {
    const double half = bernstein(n, p * (1 - p), 1.0, rho) + 1.0 / n;
    const auto quantile_ms = [&](double probability) {
      probability = std::clamp(probability, 0.0, 1.0);
      constexpr double kEnd = 1e-19;  // the last number that can be drawn
      return delay_quantile(law, std::max(probability, kEnd), std::max(1.0 - probability, kEnd)) * 1e3;
    };
    const auto at = std::min(drawn_ns.size() - 1, static_cast<std::size_t>(p * n));
    constexpr double kRounding_ms = 2e-6;
    checks.within(fmt::format("delay p{:g}", 100 * p), "ms", static_cast<double>(drawn_ns[at]) * 1e-6,
                  quantile_ms(p), quantile_ms(p - half) - kRounding_ms, quantile_ms(p + half) + kRounding_ms);
  }
}

/// `rho`: correlation of neighbours. Means within inner normal scores: there every value is bounded, so the
/// bounds hold for the heaviest tail.
void check_moments(const DelayParameters& law, double rho, const std::vector<std::int64_t>& drawn_ns,
                   Checks& checks) {
  const auto n = static_cast<double>(drawn_ns.size());
  const Moments nominal = delay_moments(law, kWinsorScore);
  const double low_s = delay_at_normal(law, -kWinsorScore);
  const double high_s = delay_at_normal(law, kWinsorScore);
  double sum = 0.0;
  double squares = 0.0;
  for (const std::int64_t ns : drawn_ns) {
    const double x = std::clamp(static_cast<double>(ns) * kNs, low_s, high_s) - nominal.mean_s;
    sum += x;
    squares += x * x;
  }
  const double variance = nominal.sd_s * nominal.sd_s;
  const double reach = std::max(high_s - nominal.mean_s, nominal.mean_s - low_s);
  constexpr double kRounding_s = 1e-9;
  checks.near("delay mean", "ms", (nominal.mean_s + sum / n) * 1e3, nominal.mean_s * 1e3,
              (bernstein(n, variance, reach, rho) + kRounding_s) * 1e3);
  const double square_variance = nominal.fourth_s4 - variance * variance;
  const double half = bernstein(n, square_variance, reach * reach, rho) + 2 * reach * kRounding_s;
  checks.within("delay sd", "ms", std::sqrt(squares / n) * 1e3, nominal.sd_s * 1e3,
                std::sqrt(std::max(0.0, variance - half)) * 1e3, std::sqrt(variance + half) * 1e3);
}

void check_correlation(const DelayParameters& law, double rho, const std::vector<std::int64_t>& drawn_ns,
                       Checks& checks) {
  if (drawn_ns.size() < 100) return;
  const DelayTable table(law);
  double products = 0.0;
  double squares = 0.0;
  double last = table.normal_score(drawn_ns.front());
  for (std::size_t i = 1; i < drawn_ns.size(); ++i) {
    const double score = table.normal_score(drawn_ns[i]);
    products += score * last;
    squares += 0.5 * (score * score + last * last);
    last = score;
  }
  const auto n = static_cast<double>(drawn_ns.size());
  checks.near("delay lag-1 correlation", "", products / squares, rho,
              std::sqrt(2 * kLogAlarm * (1 - rho * rho) / n) + 4 * kLogAlarm / n);
}

/// Normal scores can be told from delays only where the law has neither steps nor flat stretches.
bool is_invertible(const DelayParameters& law) {
  if (law.distribution != DelayDistribution::kTable) {
    // Where the delay hardly grows from score to score, whole nanoseconds tell nothing.
    constexpr double kStep = 0.25;
    constexpr double kMinRise_s = 25e-9;
    for (int i = -8; i < 14; ++i) {
      if (delay_at_normal(law, (i + 1) * kStep) - delay_at_normal(law, i * kStep) < kMinRise_s) return false;
    }
    return true;
  }
  for (std::size_t i = 1; i < law.table_s.size(); ++i) {
    if (law.table_s[i] - law.table_s[i - 1] < 1e-5) return false;
  }
  return true;
}

}  // namespace

void check_delay(const Conditions& nominal, const Run& run, double rate_hz, Checks& checks) {
  const DelayParameters& law = nominal.delay;
  const double rho = correlation_over(law, 1.0 / rate_hz);  // of neighbours
  if (law.distribution == DelayDistribution::kConstant) {
    const std::int64_t expected_ns = std::llround(law.delay_s * 1e9);
    std::uint64_t others = 0;
    for (const Sent& sent : run.sent) others += sent.outcome.drawn_ns != expected_ns;
    checks.near("delay", "ms", static_cast<double>(run.sent.front().outcome.drawn_ns) * 1e-6,
                law.delay_s * 1e3, 1e-6);
    checks.none("other delays than that", others);
  } else {
    std::vector<std::int64_t> drawn_ns;
    drawn_ns.reserve(run.sent.size());
    for (const Sent& sent : run.sent) drawn_ns.push_back(sent.outcome.drawn_ns);
    check_moments(law, rho, drawn_ns, checks);
    if (is_invertible(law)) check_correlation(law, rho, drawn_ns, checks);
    check_quantiles(law, rho, std::move(drawn_ns), checks);
  }
  if (nominal.order == Order::kFree && law.distribution != DelayDistribution::kConstant) {
    std::uint64_t overtaking = 0;
    for (std::size_t i = 1; i < run.sent.size(); ++i) {
      overtaking += run.sent[i].in_ns + run.sent[i].outcome.drawn_ns <
                    run.sent[i - 1].in_ns + run.sent[i - 1].outcome.drawn_ns;
    }
    const auto n = static_cast<double>(run.sent.size() - 1);
    const double p = overtaking_probability(law, 1.0 / rate_hz);
    // A function of two neighbours: its covariances reach one packet further than the delay's own, so its
    // variance grows by 1 + 2 / (1 - rho) at most; 1 / (2 - rho) is the memory that means the same to
    // bernstein().
    constexpr double kIntegration = 2e-4;
    const double half = bernstein(n, p * (1 - p), 1.0, 1 / (2 - rho)) + kIntegration;
    checks.near("overtakes predecessor", "", static_cast<double>(overtaking) / n, p, half);
  }
}

}  // namespace telekerf::netem
