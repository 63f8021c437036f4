// SPDX-License-Identifier: Apache-2.0
// How much of a random state is left after some time: what makes correlation a matter of time, not of
// packets.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace telekerf::netem {

/// exp(-elapsed / constant), for elapsed >= 0 and constant > 0. Sums and products only, no libm call that
/// rounds: the same on every machine. Relative error below 1e-14.
inline double decay(double elapsed, double constant) noexcept {
  const double turns = elapsed / constant * std::numbers::log2e;
  constexpr double kUnderflow = 1000.0;
  if (turns >= kUnderflow) return 0.0;
  const auto whole = static_cast<int>(turns);
  const double y = (static_cast<double>(whole) - turns) * std::numbers::ln2;  // (-ln 2, 0]
  double sum = 1.0;
  for (int term = 16; term > 0; --term) sum = 1.0 + y / term * sum;
  return std::ldexp(sum, -whole);
}

}  // namespace telekerf::netem
