// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/dose_limits.h"

#include <fmt/format.h>

#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "slave/laser/dose_book.h"

namespace telekerf::laser {

void add_dose_parameters(InterlockSettings& limits, Settings& settings) {
  settings.add("dose_max_j", limits.max_dose_j, {.min = 0.01, .max = 1000, .unit = "J"},
               "energy that no place gets more of within 0.1 mm, over all passes");
  settings.add("dose_max_j_per_mm2", limits.max_area_dose_j_per_mm2,
               {.min = 0.1, .max = 1000, .unit = "J/mm^2"},
               "mean energy that no square millimetre gets more of, over all passes");
}

void require_dose(const InterlockSettings& limits, double laser_w, double speed_mm_s,
                  std::string_view speed_key) {
  const double pass_j = laser_w / (1e-3 * speed_mm_s) * (2.0 * DoseBook::kRadius_m + DoseBook::kCell_m);
  if (pass_j <= limits.max_dose_j) return;
  throw configuration_error(
      fmt::format("laser_w = {:g} at {} = {:g} gives a place {:.2g} J in one pass, more than "
                  "dose_max_j = {:g}; lower the power, or raise dose_max_j if the material bears it",
                  laser_w, speed_key, speed_mm_s, pass_j, limits.max_dose_j));
}

}  // namespace telekerf::laser
