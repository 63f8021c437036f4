// SPDX-License-Identifier: Apache-2.0
// How much energy a felt force may give to the hand that feels it: what was there at the start, what the hand
// itself has paid, and what drag has taken (one-port passivity, after Franken's two layers). Holds for any
// wished force: late, lost, invented.
#pragma once

#include <algorithm>
#include <cmath>

namespace telekerf::master {

struct EnergyTankSettings {
  double initial_j = 2e-3;
  double max_j = 50e-3;  ///< an hour of work is not given back in a second
  double refill = 0.9;   ///< share of what the drag takes that goes in; below 1
};

/// Never below zero. No allocation.
class EnergyTank {
 public:
  explicit EnergyTank(const EnergyTankSettings& settings = {}) noexcept
      : settings_(settings), level_j_(settings.initial_j) {}

  double level_j() const noexcept { return level_j_; }

  /// The largest share of `wished_n`, 0 to 1, that a step of `dt_s` can pay for. Without the force the mean
  /// speed of the step is `free_m_per_s`, and each newton adds `mobility_m_per_ns` to it. A force that is no
  /// number has no share.
  double share(double wished_n, double free_m_per_s, double mobility_m_per_ns, double dt_s) const noexcept {
    const double power_w = wished_n * free_m_per_s;
    const double own_w = mobility_m_per_ns * wished_n * wished_n;  // what the force moves by itself
    const double budget_w = level_j_ / dt_s;
    if (!std::isfinite(power_w) || !std::isfinite(own_w)) return 0.0;
    if (power_w + own_w <= budget_w) return 1.0;
    // own s^2 + power s = budget, the root that is not negative, written so that nothing cancels.
    const double root = std::sqrt(power_w * power_w + 4.0 * own_w * budget_w);
    const double s = power_w > 0.0 ? 2.0 * budget_w / (power_w + root) : (root - power_w) / (2.0 * own_w);
    return std::clamp(s, 0.0, 1.0);
  }

  /// Books a step: `force_n` acted while the tool moved at `mean_m_per_s`, and the drag took `drag_j`. False:
  /// there is not so much, and nothing is booked.
  bool pay(double force_n, double mean_m_per_s, double drag_j, double dt_s) noexcept {
    // Rounding of the root above; it is given away to nobody.
    constexpr double kRounding_j = 1e-15;
    const double left_j = level_j_ - force_n * mean_m_per_s * dt_s + settings_.refill * std::max(0.0, drag_j);
    if (!(left_j >= -kRounding_j)) return false;
    level_j_ = std::clamp(left_j, 0.0, settings_.max_j);
    return true;
  }

 private:
  EnergyTankSettings settings_;
  double level_j_;
};

}  // namespace telekerf::master
