// SPDX-License-Identifier: Apache-2.0
// The beam as the workpiece meets it: pulses of equal energy, and a power that follows the tool's speed.
#pragma once

#include <algorithm>

namespace telekerf::workpiece {

struct PulsedSourceSettings {
  double max_power_w = 20.0;
  double repetition_hz = 20e3;
  double spot_radius_m = 30e-6;  ///< 1/e^2 radius at the focus
  double rayleigh_m = 1.8e-3;    ///< the spot's area doubles this far from the focus (pi w^2 / (M^2 lambda))

  double pulse_energy_j() const noexcept { return max_power_w / repetition_hz; }
};

struct BeamPowerSettings {
  double speed_m_per_s = 10e-3;         ///< with the whole power; by default a hand's 20 mm/s, scaled by half
  double floor_m_per_s = 0.3e-3;        ///< a slower tool gets nothing
  static constexpr double kMost = 1.5;  ///< times the power, however fast the tool is
};

/// Fraction of the power. A speed that is no magnitude gets nothing.
inline double power_fraction(const BeamPowerSettings& settings, double speed_m_per_s) noexcept {
  if (!(speed_m_per_s >= settings.floor_m_per_s)) return 0.0;
  return std::min(speed_m_per_s / settings.speed_m_per_s, BeamPowerSettings::kMost);
}

}  // namespace telekerf::workpiece
