// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/pulsed_beam.h"

namespace telekerf::laser {

void PulsedBeam::expose(const Vec2& from_m, const Vec2& to_m, double power_w, double dt_s,
                        const geometry::NearestIndex* corridor, double corridor_m, double defocus_m) {
  const PulsedSource::Pulses pulses = source_.fire(power_w, dt_s);
  const double energy_j = source_.pulse_energy_j();
  const double radius_m = source_.spot_radius_m(defocus_m);
  for (int i = 0; i < pulses.count; ++i) {
    const Vec2 at_m = from_m + (pulses.first + i * pulses.step) * (to_m - from_m);
    workpiece_.ablate(at_m, energy_j, radius_m);
    const bool outside =
        !workpiece_.covers(at_m) || (corridor != nullptr && corridor->find(at_m).distance_m > corridor_m);
    (outside ? energy_.outside_j : energy_.inside_j) += energy_j;
    energy_.absorbed_j += workpiece_.material().absorption * energy_j;
  }
}

}  // namespace telekerf::laser
