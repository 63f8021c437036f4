// SPDX-License-Identifier: Apache-2.0
#include "netem/core/delay_distribution.h"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numbers>

#include "netem/core/decay.h"

namespace telekerf::netem {
namespace {

/// Double precision is plenty for tables of whole nanoseconds.
using Precision = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

/// Symmetric laws about zero with standard deviation 1.
double symmetric_quantile(DelayDistribution distribution, double lower, double upper) {
  if (lower > upper) return -symmetric_quantile(distribution, upper, lower);
  switch (distribution) {
    case DelayDistribution::kUniform:
      return std::numbers::sqrt3 * (2.0 * lower - 1.0);
    case DelayDistribution::kNormal:
      return -normal_above(lower);
    default:
      return std::log(2.0 * lower) / std::numbers::sqrt2;  // Laplace
  }
}

/// Share of a symmetric law below -x (x >= 0, in standard deviations).
double symmetric_share_below(DelayDistribution distribution, double x) {
  switch (distribution) {
    case DelayDistribution::kUniform:
      return std::max(0.0, 0.5 * (1.0 - x / std::numbers::sqrt3));
    case DelayDistribution::kNormal:
      return normal_tail(x);
    default:
      return 0.5 * std::exp(-std::numbers::sqrt2 * x);
  }
}

/// Laws that begin at zero, with standard deviation 1.
double one_sided_quantile(DelayDistribution distribution, double shape, double lower, double upper) {
  switch (distribution) {
    case DelayDistribution::kGamma: {
      const double x = lower < upper ? boost::math::gamma_p_inv(shape, lower, Precision())
                                     : boost::math::gamma_q_inv(shape, upper, Precision());
      return x / std::sqrt(shape);
    }
    case DelayDistribution::kLognormal: {
      const double z = symmetric_quantile(DelayDistribution::kNormal, lower, upper);
      const double variance = std::expm1(shape * shape) * std::exp(shape * shape);  // at median 1
      return std::exp(shape * z) / std::sqrt(variance);
    }
    default: {  // Pareto beginning at zero (Lomax), with its real tail
      const double sd = std::sqrt(shape / (shape - 2.0)) / (shape - 1.0);
      return std::expm1(-std::log(upper) / shape) / sd;
    }
  }
}

double table_quantile(const DelayParameters& law, double lower) {
  const auto above = std::upper_bound(law.table_p.begin(), law.table_p.end(), lower);
  if (above == law.table_p.end()) return law.table_s.back();
  const auto i = above - law.table_p.begin();
  const double part = (lower - law.table_p[i - 1]) / (law.table_p[i] - law.table_p[i - 1]);
  return std::lerp(law.table_s[i - 1], law.table_s[i], part);
}

/// Exact, steps and all: between two quantiles the law is uniform.
Moments table_moments(const DelayParameters& law, double z_limit) {
  struct Piece {
    double weight, from_s, to_s;
  };
  const double tail = normal_tail(z_limit);
  const double low_s = table_quantile(law, tail);
  const double high_s = table_quantile(law, 1.0 - tail);
  std::vector<Piece> pieces{{tail, low_s, low_s}, {tail, high_s, high_s}};
  for (std::size_t i = 1; i < law.table_p.size(); ++i) {
    const double from = std::max(law.table_p[i - 1], tail);
    const double to = std::min(law.table_p[i], 1.0 - tail);
    if (to > from) {
      pieces.push_back({to - from, table_quantile(law, from), std::min(high_s, law.table_s[i])});
    }
  }
  Moments moments;
  for (const Piece& piece : pieces) moments.mean_s += piece.weight * 0.5 * (piece.from_s + piece.to_s);
  double variance = 0.0;
  for (const Piece& piece : pieces) {
    const double a = piece.from_s - moments.mean_s;
    const double b = piece.to_s - moments.mean_s;
    variance += piece.weight * (a * a + a * b + b * b) / 3.0;
    moments.fourth_s4 +=
        piece.weight * (a * a * a * a + a * b * (a * a + a * b + b * b) + b * b * b * b) / 5.0;
  }
  moments.mean_s += law.delay_s;
  moments.sd_s = std::sqrt(variance);
  return moments;
}

}  // namespace

double normal_tail(double z) { return 0.5 * std::erfc(z / std::numbers::sqrt2); }

double normal_above(double tail) {
  return std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * tail, Precision());
}

double delay_quantile(const DelayParameters& law, double lower, double upper) {
  switch (law.distribution) {
    case DelayDistribution::kConstant:
      return law.delay_s;
    case DelayDistribution::kUniform:
    case DelayDistribution::kNormal:
    case DelayDistribution::kLaplace: {
      const double cut = symmetric_share_below(law.distribution, law.delay_s / law.jitter_s);
      const double x = symmetric_quantile(law.distribution, cut + (1.0 - cut) * lower, (1.0 - cut) * upper);
      return std::max(0.0, law.delay_s + law.jitter_s * x);
    }
    case DelayDistribution::kGamma:
    case DelayDistribution::kLognormal:
    case DelayDistribution::kPareto:
      return law.delay_s + law.jitter_s * one_sided_quantile(law.distribution, law.shape, lower, upper);
    case DelayDistribution::kTable:
      return law.delay_s + table_quantile(law, lower);
  }
  return law.delay_s;
}

double delay_at_normal(const DelayParameters& law, double z) {
  return delay_quantile(law, normal_tail(-z), normal_tail(z));
}

double correlation_over(const DelayParameters& law, double interval_s) {
  return law.correlation_s > 0 ? decay(interval_s, law.correlation_s) : 0.0;
}

Moments delay_moments(const DelayParameters& law, double z_limit) {
  if (law.distribution == DelayDistribution::kConstant) return {law.delay_s, 0.0, 0.0};
  if (law.distribution == DelayDistribution::kTable) return table_moments(law, z_limit);
  // Simpson's rule over z; the two tails beyond the limit carry the limit's own value.
  constexpr int kSteps = 2048;
  const double step = 2.0 * z_limit / kSteps;
  std::vector<double> delay(kSteps + 1);
  std::vector<double> weight(kSteps + 1);
  double mass = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double z = -z_limit + i * step;
    const double simpson = i == 0 || i == kSteps ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
    delay[i] = delay_at_normal(law, z);
    weight[i] = simpson * step / 3.0 * std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
    if (i == 0 || i == kSteps) weight[i] += normal_tail(z_limit);
    mass += weight[i];
  }
  Moments moments;
  for (int i = 0; i <= kSteps; ++i) moments.mean_s += weight[i] / mass * delay[i];
  double variance = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double square = (delay[i] - moments.mean_s) * (delay[i] - moments.mean_s);
    variance += weight[i] / mass * square;
    moments.fourth_s4 += weight[i] / mass * square * square;
  }
  moments.sd_s = std::sqrt(variance);
  return moments;
}

}  // namespace telekerf::netem
