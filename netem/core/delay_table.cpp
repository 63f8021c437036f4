// SPDX-License-Identifier: Apache-2.0
#include "netem/core/delay_table.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "netem/core/delay_distribution.h"

namespace telekerf::netem {
namespace {

constexpr int kPartsBits = 6;
constexpr int kParts = 1 << kPartsBits;  // linear pieces in one octave of the tail probability
constexpr int kOctaves = 63;
constexpr double kReach = 9.25;  // in z
constexpr int kNodesPerUnit = 64;
constexpr int kNodes = static_cast<int>(2 * kReach * kNodesPerUnit) + 1;

/// On a grid of 2^-40, so that the last digits of a library's functions leave no trace.
double on_grid(double x) { return std::ldexp(std::round(std::ldexp(x, 40)), -40); }

}  // namespace

NormalTable::NormalTable() : cells_(std::size_t{kOctaves} * kParts) {
  for (int octave = 0; octave < kOctaves; ++octave) {
    for (int part = 0; part < kParts; ++part) {
      const double scale = std::ldexp(1.0, -(octave + 2));  // octave 0: tail probabilities [1/4, 1/2)
      const double here = on_grid(normal_above(scale * (1.0 + static_cast<double>(part) / kParts)));
      const double next = on_grid(normal_above(scale * (1.0 + static_cast<double>(part + 1) / kParts)));
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

DelayTable::DelayTable(const DelayParameters& law) {
  constexpr double kLongest_ns =
      3.6e12;  // an hour; beyond every quantile that a bounded law of a profile can draw
  const auto z_at = [](int node) { return -kReach + static_cast<double>(node) / kNodesPerUnit; };
  if (law.distribution == DelayDistribution::kTable) {
    for (int i = 0; i < kNodes; ++i) probabilities_.push_back(on_grid(normal_tail(-z_at(i))));
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
  if (!probabilities_.empty()) return in_table(node, part);
  const std::int64_t here = nodes_ns_[node];
  const auto rise = static_cast<double>(nodes_ns_[node + 1] - here);
  return here + rounded(rise * part);
}

std::int64_t DelayTable::in_table(std::size_t node, double part) const noexcept {
  const double probability = probabilities_[node] + (probabilities_[node + 1] - probabilities_[node]) * part;
  const auto above =
      std::upper_bound(table_p_.begin() + 1, table_p_.end() - 1, probability) - table_p_.begin();
  const std::int64_t here = table_ns_[above - 1];
  const auto rise = static_cast<double>(table_ns_[above] - here);
  const double passed = (probability - table_p_[above - 1]) / (table_p_[above] - table_p_[above - 1]);
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
  if (probabilities_.empty()) return place(nodes_ns_, delay) / kNodesPerUnit - kReach;
  const double at = place(table_ns_, delay);
  const auto i = std::min(static_cast<std::size_t>(at), table_p_.size() - 2);
  const double probability = std::lerp(table_p_[i], table_p_[i + 1], at - static_cast<double>(i));
  return place(probabilities_, probability) / kNodesPerUnit - kReach;
}

}  // namespace telekerf::netem
