// SPDX-License-Identifier: Apache-2.0
// What a joule removes: volume above a threshold, so that depth is inversely proportional to speed (thesis
// ch. 4).
#pragma once

#include <string>
#include <vector>

namespace telekerf::laser {

/// Ablation by heating: of a pulse's fluence F (J/m^2 absorbed) the part above the threshold removes
/// depth = (F - threshold) / heat_of_removal. Many pulses overlap, so the depth along a line is
/// power / (heat_of_removal width speed), less the threshold's share.
struct Material {
  std::string name;
  double absorption = 0.8;                ///< share of the beam that stays, at 1065 nm
  double threshold_j_per_m2 = 500.0;      ///< of one pulse
  double heat_of_removal_j_per_m3 = 3e9;  ///< to heat and remove
  double thickness_m = 3e-3;              ///< deeper there is nothing left
  double char_depth_m = 0.1e-3;           ///< where a mark looks fully dark
  int paper_bgr[3] = {150, 195, 226};     ///< its colour
  int burnt_bgr[3] = {18, 26, 38};

  /// Depth that one pulse removes where its fluence is `fluence_j_per_m2` (incident).
  double depth_m(double fluence_j_per_m2) const noexcept {
    const double above = absorption * fluence_j_per_m2 - threshold_j_per_m2;
    return above > 0.0 ? above / heat_of_removal_j_per_m3 : 0.0;
  }
};

/// "wood" or "fibreglass" (black). Throws StartupError that lists them.
Material material(const std::string& name);
std::vector<std::string> material_names();

}  // namespace telekerf::laser
