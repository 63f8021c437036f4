// SPDX-License-Identifier: Apache-2.0
// What a joule removes: volume above a threshold, so that depth is inversely proportional to speed (thesis
// ch. 4).
#pragma once

#include <string_view>

#include "common/runtime/enum_table.h"

namespace telekerf::workpiece {

/// Ablation by heating: of a pulse's fluence F (J/m^2 absorbed) the part above the threshold removes
/// depth = (F - threshold) / heat_of_removal. Many pulses overlap, so the depth along a line is
/// power / (heat_of_removal width speed), less the threshold's share.
struct Material {
  std::string_view name;
  double absorption = 0.8;                ///< fraction of the beam that stays, at 1065 nm
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

// Orders of magnitude from the ablation literature; the thesis gives none. Wood at 2 mm/s and 10 W: about 1
// mm.
inline constexpr Material kWood{.name = "wood",
                                .absorption = 0.7,
                                .threshold_j_per_m2 = 300.0,
                                .heat_of_removal_j_per_m3 = 60e9,
                                .thickness_m = 3e-3,
                                .char_depth_m = 0.1e-3,
                                .paper_bgr = {150, 195, 226},
                                .burnt_bgr = {18, 26, 38}};
inline constexpr Material kFibreglass{.name = "fibreglass",
                                      .absorption = 0.9,
                                      .threshold_j_per_m2 = 1500.0,
                                      .heat_of_removal_j_per_m3 = 90e9,
                                      .thickness_m = 0.5e-3,
                                      .char_depth_m = 0.05e-3,
                                      .paper_bgr = {52, 50, 48},
                                      .burnt_bgr = {205, 212, 214}};

/// A material is a row, and nothing else.
inline constexpr EnumRow<const Material*> kMaterialRows[] = {
    {kWood.name, &kWood, "3 mm, light; chars"},
    {kFibreglass.name, &kFibreglass, "0.5 mm, black; harder to remove"},
};
inline constexpr EnumTable<const Material*> kMaterials(kMaterialRows);

}  // namespace telekerf::workpiece
