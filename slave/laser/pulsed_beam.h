// SPDX-License-Identifier: Apache-2.0
// A pulsed source above a workpiece: its pulses dig, its joules are booked inside and outside the corridor.
#pragma once

#include "common/geometry/corridor.h"
#include "common/geometry/nearest.h"
#include "common/workpiece/workpiece.h"
#include "slave/laser/pulsed_source.h"

namespace telekerf::laser {

struct EnergyStatistics {
  double inside_j = 0.0;
  double outside_j = 0.0;  ///< beyond the corridor, or off the workpiece's raster
  double absorbed_j = 0.0;
};

class PulsedBeam {
 public:
  /// The workpiece must outlive the beam.
  PulsedBeam(const PulsedSourceSettings& source, workpiece::Workpiece& workpiece) noexcept
      : source_(source), workpiece_(workpiece) {}

  /// The beam moved from `from_m` to `to_m` (workpiece frame) in `dt_s` with `power_w`; pulses are where
  /// the beam is when they leave. `corridor`: null, or the contour whose energy is booked within `corridor_m`
  /// to either side of it. `defocus_m`: distance of the surface from the focus.
  void expose(const Vec2& from_m, const Vec2& to_m, double power_w, double dt_s,
              const geometry::NearestIndex* corridor = nullptr,
              double corridor_m = geometry::kCorridorHalfWidth_m, double defocus_m = 0.0);

  const EnergyStatistics& energy() const noexcept { return energy_; }

 private:
  PulsedSource source_;
  workpiece::Workpiece& workpiece_;
  EnergyStatistics energy_;
};

}  // namespace telekerf::laser
