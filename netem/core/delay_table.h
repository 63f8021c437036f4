// SPDX-License-Identifier: Apache-2.0
// What the packet path draws delays with: tables, so that the same draw is the same delay on every machine.
#pragma once

#include <cstdint>
#include <vector>

#include "netem/core/profile.h"

namespace telekerf::netem {

/// To the nearest whole number, for values of 0 or more; no call into the library.
constexpr std::int64_t rounded(double value) noexcept {
  constexpr double kHalf = 0.5;
  return static_cast<std::int64_t>(value + kHalf);
}

/// A standard normal number from 64 random bits, monotone in the word's magnitude; |z| <= 9.1.
/// Tables, no libm call: the same on every machine and at every optimisation level.
class NormalTable {
 public:
  static const NormalTable& instance();
  double at(std::uint64_t word) const noexcept;

 private:
  NormalTable();
  struct Cell {
    double value, rise;
  };
  std::vector<Cell> cells_;  // (octave of the tail probability) x kParts
};

/// z -> delay in whole nanoseconds, linear between 64 nodes per unit of z. A table may have steps that such
/// nodes would round off: there the probabilities Phi(z) are kept, and the delay is looked up in the table
/// itself.
class DelayTable {
 public:
  explicit DelayTable(const DelayParameters& law);
  std::int64_t at(double z) const noexcept;
  /// The inverse, for statistics: the normal score of a delay (its lower end where the law is flat).
  double normal_score(std::int64_t delay_ns) const;

 private:
  std::int64_t in_table(std::size_t node, double part) const noexcept;

  std::vector<std::int64_t> nodes_ns_;
  std::vector<double> probabilities_;  ///< at the nodes; empty unless the law is a table
  std::vector<double> table_p_;
  std::vector<std::int64_t> table_ns_;
};

}  // namespace telekerf::netem
