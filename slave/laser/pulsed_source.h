// SPDX-License-Identifier: Apache-2.0
// A pulsed fibre laser like SPI's G3 (thesis 7.1.3): pulses of equal energy at a steady rate, a Gaussian beam
// with a waist at the focus.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/workpiece/beam.h"

namespace telekerf::laser {

using workpiece::PulsedSourceSettings;

/// Pulses on demand: each has the energy of full power at the full rate, and the rate follows the power. So
/// every pulse is equally far above the material's threshold, and depth follows the energy a length. Pulses
/// are whole and evenly spaced; what is left of one waits for the next call.
class PulsedSource {
 public:
  explicit PulsedSource(const PulsedSourceSettings& settings) noexcept : settings_(settings) {}

  double pulse_energy_j() const noexcept { return settings_.pulse_energy_j(); }
  /// The pulses of one call: how many, and when, as shares of its time.
  struct Pulses {
    int count = 0;
    double first = 0.0;
    double step = 0.0;
  };
  /// Within `dt_s` at an average power, which is clipped to what the source has.
  Pulses fire(double power_w, double dt_s) noexcept {
    if (!(power_w > 0.0)) return {};
    const double due = std::min(power_w, settings_.max_power_w) * dt_s / pulse_energy_j();
    const double first = (1.0 - phase_) / due;
    phase_ += due;
    const double whole = std::floor(phase_);
    phase_ -= whole;
    return {static_cast<int>(whole), first, 1.0 / due};
  }
  /// 1/e^2 radius at a distance from the focus.
  double spot_radius_m(double defocus_m) const noexcept {
    return settings_.spot_radius_m * std::hypot(1.0, defocus_m / settings_.rayleigh_m);
  }
  const PulsedSourceSettings& settings() const noexcept { return settings_; }

 private:
  PulsedSourceSettings settings_;
  double phase_ = 0.0;
};

}  // namespace telekerf::laser
