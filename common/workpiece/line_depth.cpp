// SPDX-License-Identifier: Apache-2.0
#include "common/workpiece/line_depth.h"

#include <cmath>
#include <numbers>

namespace telekerf::workpiece {

double depth_speed_m2_per_s(const Material& material, double power_w, const PulsedSourceSettings& source) {
  const double pulse_j = source.pulse_energy_j();
  const double w = source.spot_radius_m;
  const double peak = material.absorption * 2.0 * pulse_j / (std::numbers::pi * w * w);
  if (peak <= material.threshold_j_per_m2) return 0.0;
  // Of pulses side by side, the part of a Gaussian's profile above the threshold, summed along the line.
  const double reach = w * std::sqrt(0.5 * std::log(peak / material.threshold_j_per_m2));
  const double above =
      peak * w * std::sqrt(0.5 * std::numbers::pi) * std::erf(std::numbers::sqrt2 * reach / w) -
      2.0 * reach * material.threshold_j_per_m2;
  return power_w / pulse_j * above / material.heat_of_removal_j_per_m3;
}

}  // namespace telekerf::workpiece
