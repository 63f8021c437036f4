// SPDX-License-Identifier: Apache-2.0
#include "netem/core/law.h"

#include <algorithm>
#include <bit>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numbers>

namespace telekerf::netem {
namespace {

/// Double precision is plenty for tables of whole nanoseconds.
using Precision = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

constexpr int kPartsBits = 6;
constexpr int kParts = 1 << kPartsBits;  // linear pieces in one octave of the tail probability
constexpr int kOctaves = 63;
constexpr double kReach = 9.25;  // in z
constexpr int kNodesPerUnit = 64;
constexpr int kNodes = static_cast<int>(2 * kReach * kNodesPerUnit) + 1;

/// On a grid of 2^-40, so that the last digits of a library's functions leave no trace.
double on_grid(double x) { return std::ldexp(std::round(std::ldexp(x, 40)), -40); }

/// The normal number above which the share `upper` <= 0.5 lies.
double normal_above(double upper) {
  return on_grid(std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * upper, Precision()));
}

double upper_of(double z) { return 0.5 * std::erfc(z / std::numbers::sqrt2); }

/// Symmetric laws about zero with standard deviation 1.
double symmetric_quantile(Law law, double lower, double upper) {
  if (lower > upper) return -symmetric_quantile(law, upper, lower);
  switch (law) {
    case Law::kUniform:
      return std::numbers::sqrt3 * (2.0 * lower - 1.0);
    case Law::kNormal:
      return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * lower, Precision());
    default:
      return std::log(2.0 * lower) / std::numbers::sqrt2;  // Laplace
  }
}

/// Share of a symmetric law below -x (x >= 0, in standard deviations).
double symmetric_share_below(Law law, double x) {
  switch (law) {
    case Law::kUniform:
      return std::max(0.0, 0.5 * (1.0 - x / std::numbers::sqrt3));
    case Law::kNormal:
      return upper_of(x);
    default:
      return 0.5 * std::exp(-std::numbers::sqrt2 * x);
  }
}

/// Laws that begin at zero, with standard deviation 1.
double one_sided_quantile(Law law, double shape, double lower, double upper) {
  switch (law) {
    case Law::kGamma: {
      const double x = lower < upper ? boost::math::gamma_p_inv(shape, lower, Precision())
                                     : boost::math::gamma_q_inv(shape, upper, Precision());
      return x / std::sqrt(shape);
    }
    case Law::kLognormal: {
      const double z = symmetric_quantile(Law::kNormal, lower, upper);
      const double variance = std::expm1(shape * shape) * std::exp(shape * shape);  // at median 1
      return std::exp(shape * z) / std::sqrt(variance);
    }
    default: {  // Pareto beginning at zero (Lomax), with its real tail
      const double sd = std::sqrt(shape / (shape - 2.0)) / (shape - 1.0);
      return std::expm1(-std::log(upper) / shape) / sd;
    }
  }
}

double table_quantile(const DelayLaw& law, double lower) {
  const auto above = std::upper_bound(law.table_p.begin(), law.table_p.end(), lower);
  if (above == law.table_p.end()) return law.table_s.back();
  const auto i = above - law.table_p.begin();
  const double part = (lower - law.table_p[i - 1]) / (law.table_p[i] - law.table_p[i - 1]);
  return std::lerp(law.table_s[i - 1], law.table_s[i], part);
}

/// Exact, steps and all: between two quantiles the law is uniform.
Moments table_moments(const DelayLaw& law, double z_limit) {
  struct Piece {
    double share, from_s, to_s;
  };
  const double tail = upper_of(z_limit);
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
  for (const Piece& piece : pieces) moments.mean_s += piece.share * 0.5 * (piece.from_s + piece.to_s);
  double variance = 0.0;
  for (const Piece& piece : pieces) {
    const double a = piece.from_s - moments.mean_s;
    const double b = piece.to_s - moments.mean_s;
    variance += piece.share * (a * a + a * b + b * b) / 3.0;
    moments.fourth_s4 +=
        piece.share * (a * a * a * a + a * b * (a * a + a * b + b * b) + b * b * b * b) / 5.0;
  }
  moments.mean_s += law.delay_s;
  moments.sd_s = std::sqrt(variance);
  return moments;
}

}  // namespace

NormalTable::NormalTable() : cells_(std::size_t{kOctaves} * kParts) {
  for (int octave = 0; octave < kOctaves; ++octave) {
    for (int part = 0; part < kParts; ++part) {
      const double scale = std::ldexp(1.0, -(octave + 2));  // octave 0: tail probabilities [1/4, 1/2)
      const double here = normal_above(scale * (1.0 + static_cast<double>(part) / kParts));
      const double next = normal_above(scale * (1.0 + static_cast<double>(part + 1) / kParts));
      cells_[static_cast<std::size_t>(octave) * kParts + part] = {here, next - here};
    }
  }
}

const NormalTable& NormalTable::instance() {
  static const NormalTable table;
  return table;
}

double NormalTable::at(std::uint64_t word) const noexcept {
  const std::uint64_t magnitude = (word << 1) | 2;  // the top bit is the sign; never zero
  const int octave = std::countl_zero(magnitude);
  const std::uint64_t digits = magnitude << octave << 1;  // after the leading one
  const auto part = static_cast<std::size_t>(digits >> (64 - kPartsBits));
  const double rest = static_cast<double>((digits << kPartsBits) >> 12) * 0x1p-52;
  const Cell& cell = cells_[static_cast<std::size_t>(octave) * kParts + part];
  const double z = cell.value + rest * cell.rise;  // never negative
  const std::uint64_t sign = ~word & (1ULL << 63);
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(z) | sign);
}

double delay_quantile(const DelayLaw& law, double lower, double upper) {
  switch (law.law) {
    case Law::kConstant:
      return law.delay_s;
    case Law::kUniform:
    case Law::kNormal:
    case Law::kLaplace: {
      const double cut = symmetric_share_below(law.law, law.delay_s / law.jitter_s);
      const double x = symmetric_quantile(law.law, cut + (1.0 - cut) * lower, (1.0 - cut) * upper);
      return std::max(0.0, law.delay_s + law.jitter_s * x);
    }
    case Law::kGamma:
    case Law::kLognormal:
    case Law::kPareto:
      return law.delay_s + law.jitter_s * one_sided_quantile(law.law, law.shape, lower, upper);
    case Law::kTable:
      return law.delay_s + table_quantile(law, lower);
  }
  return law.delay_s;
}

double delay_at_normal(const DelayLaw& law, double z) {
  return delay_quantile(law, upper_of(-z), upper_of(z));
}

Moments delay_moments(const DelayLaw& law, double z_limit) {
  if (law.law == Law::kConstant) return {law.delay_s, 0.0, 0.0};
  if (law.law == Law::kTable) return table_moments(law, z_limit);
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
    if (i == 0 || i == kSteps) weight[i] += upper_of(z_limit);
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

DelayTable::DelayTable(const DelayLaw& law) {
  constexpr double kLongest_ns =
      3.6e12;  // an hour; beyond every quantile that a bounded law of a profile can draw
  const auto z_at = [](int node) { return -kReach + static_cast<double>(node) / kNodesPerUnit; };
  if (law.law == Law::kTable) {
    for (int i = 0; i < kNodes; ++i) shares_.push_back(on_grid(upper_of(-z_at(i))));
    table_p_ = law.table_p;
    for (const double s : law.table_s) table_ns_.push_back(std::llround((law.delay_s + s) * 1e9));
    return;
  }
  for (int i = 0; i < kNodes; ++i) {
    nodes_ns_.push_back(std::llround(std::min(delay_at_normal(law, z_at(i)) * 1e9, kLongest_ns)));
  }
}

std::int64_t DelayTable::at(double z) const noexcept {
  const double at = (std::clamp(z, -kReach, kReach - 1e-9) + kReach) * kNodesPerUnit;
  const auto node = static_cast<std::size_t>(at);
  const double part = at - static_cast<double>(node);
  if (!shares_.empty()) return in_table(node, part);
  const std::int64_t here = nodes_ns_[node];
  const auto rise = static_cast<double>(nodes_ns_[node + 1] - here);
  return here + rounded(rise * part);
}

std::int64_t DelayTable::in_table(std::size_t node, double part) const noexcept {
  const double share = shares_[node] + (shares_[node + 1] - shares_[node]) * part;
  const auto above = std::upper_bound(table_p_.begin() + 1, table_p_.end() - 1, share) - table_p_.begin();
  const std::int64_t here = table_ns_[above - 1];
  const auto rise = static_cast<double>(table_ns_[above] - here);
  const double passed = (share - table_p_[above - 1]) / (table_p_[above] - table_p_[above - 1]);
  return here + rounded(rise * passed);
}

double DelayTable::normal_score(std::int64_t delay_ns) const {
  /// The place among ascending `nodes` where a function that is linear between them takes `value`.
  const auto place = [](const auto& nodes, double value) {
    const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, value);
    const auto here = static_cast<double>(*(above - 1));
    const auto rise = static_cast<double>(*above) - here;
    return static_cast<double>(above - nodes.begin() - 1) + (rise > 0 ? (value - here) / rise : 0.0);
  };
  const auto delay = static_cast<double>(delay_ns);
  if (shares_.empty()) return place(nodes_ns_, delay) / kNodesPerUnit - kReach;
  const double at = place(table_ns_, delay);
  const auto i = std::min(static_cast<std::size_t>(at), table_p_.size() - 2);
  const double share = std::lerp(table_p_[i], table_p_[i + 1], at - static_cast<double>(i));
  return place(shares_, share) / kNodesPerUnit - kReach;
}

}  // namespace telekerf::netem
