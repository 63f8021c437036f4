// SPDX-License-Identifier: Apache-2.0
// The cut as the hand feels it (thesis 9.2, "non-contact haptic feedback"): a copy of the cut at the master
// says how deep the beam burns at the hand's speed; too fast is braked, too slow is helped on, along the
// curve. The beam meets no force, so all that could come back to the hand is what the tank lets through.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/recording/run_record.h"
#include "master/haptics/energy_tank.h"

namespace telekerf::master {

struct FeltCutSettings {
  double depth_m = 0.0;  ///< wished depth of the cut; 0: nothing is felt
  /// The copy: depth of a line times the speed of the beam on the workpiece, of this material and power.
  double depth_speed_m2_per_s = 3e-6;
  double gain_ns_per_m = 300.0;
  double max_n = 3.0;
  double fade_s = 0.02;  ///< of the force, where the beam begins and ends
  EnergyTankSettings tank;
};

struct FeltCutStatistics {
  std::uint64_t steps = 0;        ///< with the beam wanted
  std::uint64_t held_back = 0;    ///< among them those whose force was not given whole
  double wished_n_squared = 0.0;  ///< sums over those steps
  double felt_n_squared = 0.0;
  double given_j = 0.0;       ///< by the force to the hand's side, less what came from there
  double most_given_j = 0.0;  ///< beyond the drag: what the tank's start bounds
  double drag_j = 0.0;
};

/// Root mean squares, shares and energies of it.
void add_figures(const FeltCutStatistics& felt, Metrics& figures);

/// Along the curve, master's frame. No allocation.
class FeltCut {
 public:
  explicit FeltCut(const FeltCutSettings& settings) noexcept : settings_(settings), tank_(settings.tank) {}

  bool on() const noexcept { return settings_.depth_m > 0.0; }
  const EnergyTank& tank() const noexcept { return tank_; }
  const FeltCutStatistics& statistics() const noexcept { return statistics_; }

  /// The wished force at `speed_m_per_s` along the curve, N, positive as the speed is. `hand_n`: the hand's
  /// own; `beta`: slave motion / master motion; `cutting`: the hand holds the button and the slave follows.
  double wished_n(double speed_m_per_s, double hand_n, double beta, bool cutting, double dt_s) noexcept {
    const double right_m_per_s = settings_.depth_speed_m2_per_s / (settings_.depth_m * beta);
    // A tool that rests is not set in motion, in whatever direction that would be, and a hand that holds back
    // or turns round is not helped on.
    const double way = std::clamp(speed_m_per_s / (0.25 * right_m_per_s), -1.0, 1.0);
    double target_n = cutting ? settings_.gain_ns_per_m * (way * right_m_per_s - speed_m_per_s) : 0.0;
    if (target_n * speed_m_per_s > 0.0 && hand_n * speed_m_per_s <= 0.0) target_n = 0.0;
    smooth_n_ += std::min(1.0, dt_s / settings_.fade_s) *
                 (std::clamp(target_n, -settings_.max_n, settings_.max_n) - smooth_n_);
    if (!std::isfinite(smooth_n_)) smooth_n_ = 0.0;
    return smooth_n_;
  }

  /// One step: `mean(force_n)` is the tool's mean speed in it if that force acts. Returns what acts.
  /// `drag_ns_per_m`: what takes energy from the tool at `speed_m_per_s`, whatever is felt.
  template <typename Mean>
  double step(double wished_n, double speed_m_per_s, double drag_ns_per_m, double mobility_m_per_ns,
              double dt_s, const Mean& mean) noexcept {
    const auto drag_j = [&](double v) { return std::max(0.0, drag_ns_per_m * speed_m_per_s * v * dt_s); };
    const double free_m_per_s = mean(0.0);
    double force_n = wished_n * tank_.share(wished_n, free_m_per_s, mobility_m_per_ns, dt_s);
    double v = force_n == 0.0 ? free_m_per_s : mean(force_n);
    // Speed limits and ends of a curve bend the motion away from what the tank was asked for.
    if (!tank_.pay(force_n, v, drag_j(v), dt_s)) {
      force_n = 0.0;
      v = free_m_per_s;
      tank_.pay(0.0, v, drag_j(v), dt_s);
    }
    count(wished_n, force_n, force_n * v * dt_s, drag_j(v));
    return force_n;
  }

 private:
  void count(double wished_n, double force_n, double given_j, double drag_j) noexcept {
    FeltCutStatistics& s = statistics_;
    s.given_j += given_j;
    s.drag_j += drag_j;
    s.most_given_j = std::max(s.most_given_j, s.given_j - s.drag_j);
    if (wished_n == 0.0) return;
    ++s.steps;
    s.held_back += std::abs(force_n) < 0.999 * std::abs(wished_n) ? 1 : 0;
    s.wished_n_squared += wished_n * wished_n;
    s.felt_n_squared += force_n * force_n;
  }

  FeltCutSettings settings_;
  EnergyTank tank_;
  FeltCutStatistics statistics_;
  double smooth_n_ = 0.0;
};

}  // namespace telekerf::master
