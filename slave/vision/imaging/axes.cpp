// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/axes.h"

namespace telekerf::imaging {

AxesModel default_axes() {
  AxesModel axes;
  axes[kMagnification] = {.travel_m = 0.08,
                          .moving_mass_kg = 4.0,
                          .force_constant_n_per_a = 40.0,
                          .peak_force_n = 60.0,
                          .coulomb_n = 12.0,
                          .viscous_n_s_per_m = 60.0,
                          .backlash_m = 5e-6,
                          .speed_m_per_s = 0.04,
                          .acceleration_m_per_s2 = 0.8};
  axes[kFocus].backlash_m = 0.25e-3;
  return axes;
}

}  // namespace telekerf::imaging
