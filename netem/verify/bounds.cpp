// SPDX-License-Identifier: Apache-2.0
#include "netem/verify/bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace telekerf::netem {

double bernstein(double n, double variance, double range, double memory) {
  const double spread = (1.0 + memory) / (1.0 - memory);
  const double linear = (memory > 0 ? 5.0 / (1.0 - memory) : 1.0 / 3.0) * range * kLogAlarm;
  return (linear + std::sqrt(linear * linear + 2.0 * n * kLogAlarm * spread * variance)) / n;
}

double chain_memory(const LossChain& chain) {
  if (chain.states == 1) return 0.0;
  if (chain.states == 2) return std::max(0.0, 1.0 - chain.to[0][1] - chain.to[1][0]);
  // Power iteration on (P + 1) / 2, whose eigenvalues are not negative, with the stationary part taken out.
  // States that are never entered have no share and take no part.
  std::array<double, kMaxLossStates> x{1.0, -0.3, 0.7, -0.9};
  double growth = 0.0;
  for (int step = 0; step < 20'000; ++step) {
    double mean = 0.0;
    for (int i = 0; i < chain.states; ++i) mean += chain.stationary[i] * x[i];
    std::array<double, kMaxLossStates> next{};
    double before = 0.0;
    double after = 0.0;
    for (int i = 0; i < chain.states; ++i) x[i] -= mean;
    for (int i = 0; i < chain.states; ++i) {
      for (int j = 0; j < chain.states; ++j) next[i] += 0.5 * chain.to[i][j] * x[j];
      next[i] += 0.5 * x[i];
      before += chain.stationary[i] * x[i] * x[i];
      after += chain.stationary[i] * next[i] * next[i];
    }
    if (before <= 0) return 0.0;
    growth = std::sqrt(after / before);
    for (int i = 0; i < chain.states; ++i) {
      x[i] = after > 0 && chain.stationary[i] > 0 ? next[i] / std::sqrt(after) : 0.0;
    }
  }
  return std::clamp(2.0 * growth - 1.0, 0.0, 0.9999);
}

double burst_variance(const LossChain& chain) {
  // A chain over (state, lost or not); the function lives on its steps.
  const int n = 2 * chain.states;
  const double burst = mean_burst(chain);
  const auto emits = [&](int node) {
    return node % 2 == 1 ? chain.lost[node / 2] : 1.0 - chain.lost[node / 2];
  };
  const auto value = [&](int from, int to) {
    if (to % 2 == 0) return 0.0;
    return from % 2 == 0 ? 1.0 - burst : 1.0;
  };
  const auto step = [&](int from, int to) { return chain.to[from / 2][to / 2] * emits(to); };
  std::vector<double> arriving(n, 0.0);  // E[f(X0, X1); X1 = node]
  std::vector<double> leaving(n, 0.0);   // E[f(X0, X1) | X0 = node]
  double variance = 0.0;
  for (int i = 0; i < n; ++i) {
    const double share = chain.stationary[i / 2] * emits(i);
    for (int j = 0; j < n; ++j) {
      const double f = value(i, j);
      variance += share * step(i, j) * f * f;
      arriving[j] += share * step(i, j) * f;
      leaving[i] += step(i, j) * f;
    }
  }
  // Add twice the covariance of the step with every later one, until the chain has forgotten.
  for (int lag = 1; lag < 100'000; ++lag) {
    double covariance = 0.0;
    double weight = 0.0;
    for (int i = 0; i < n; ++i) {
      covariance += arriving[i] * leaving[i];
      weight += std::abs(arriving[i]);
    }
    variance += 2.0 * covariance;
    if (weight < 1e-9) break;
    std::vector<double> next(n, 0.0);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) next[j] += arriving[i] * step(i, j);
    }
    // The function's mean is zero, so only rounding feeds the stationary part.
    double sum = 0.0;
    for (const double x : next) sum += x;
    for (int i = 0; i < n; ++i) next[i] -= sum * chain.stationary[i / 2] * emits(i);
    arriving = next;
  }
  return std::max(variance, 0.0);
}

double overtaking_probability(const DelayParameters& law, double interval_s) {
  if (law.distribution == DelayDistribution::kConstant) return 0.0;
  const int steps = law.distribution == DelayDistribution::kTable ? 40'000 : 4'000;  // a table may have steps
  constexpr double kLimit = 8.0;
  // Delays on a grid of normal scores; the score at which the law reaches a given delay by interpolation.
  std::vector<double> delay(steps + 1);
  const auto score = [&](int i) { return -kLimit + 2.0 * kLimit * i / steps; };
  for (int i = 0; i <= steps; ++i) delay[i] = delay_at_normal(law, score(i));
  const double rho = correlation_over(law, interval_s);
  const double rest = std::sqrt(1.0 - rho * rho);
  double probability = 0.0;
  for (int i = 0; i <= steps; ++i) {
    // The next packet, interval later, must be due before this one: its delay below delay[i] - interval.
    const auto above = std::lower_bound(delay.begin(), delay.end(), delay[i] - interval_s);
    if (above == delay.begin()) continue;
    const auto j = static_cast<int>(above - delay.begin());
    const double width = delay[j] - delay[j - 1];
    const double part = width > 0 ? (delay[i] - interval_s - delay[j - 1]) / width : 1.0;
    const double limit = score(j - 1) + part * (score(j) - score(j - 1));
    const double below = 0.5 * std::erfc(-(limit - rho * score(i)) / rest / std::numbers::sqrt2);
    const double density = std::exp(-0.5 * score(i) * score(i)) / std::sqrt(2.0 * std::numbers::pi);
    probability += density * below * (2.0 * kLimit / steps);
  }
  return probability;
}

}  // namespace telekerf::netem
