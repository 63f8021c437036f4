// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/material.h"

#include "common/runtime/startup_error.h"

namespace telekerf::laser {
namespace {

// Orders of magnitude from the ablation literature; the thesis gives none. Wood at 2 mm/s and 10 W: about 1
// mm.
const std::vector<Material>& shipped() {
  static const std::vector<Material> materials{
      {.name = "wood",
       .absorption = 0.7,
       .threshold_j_per_m2 = 300.0,
       .heat_of_removal_j_per_m3 = 60e9,
       .thickness_m = 3e-3,
       .char_depth_m = 0.1e-3,
       .paper_bgr = {150, 195, 226},
       .burnt_bgr = {18, 26, 38}},
      {.name = "fibreglass",
       .absorption = 0.9,
       .threshold_j_per_m2 = 1500.0,
       .heat_of_removal_j_per_m3 = 90e9,
       .thickness_m = 0.5e-3,
       .char_depth_m = 0.05e-3,
       .paper_bgr = {52, 50, 48},
       .burnt_bgr = {205, 212, 214}},
  };
  return materials;
}

}  // namespace

Material material(const std::string& name) {
  for (const Material& m : shipped()) {
    if (m.name == name) return m;
  }
  std::string names;
  for (const auto& n : material_names()) names += (names.empty() ? "" : ", ") + n;
  throw StartupError("material = " + name + ": must be one of " + names);
}

std::vector<std::string> material_names() {
  std::vector<std::string> names;
  for (const Material& m : shipped()) names.push_back(m.name);
  return names;
}

}  // namespace telekerf::laser
