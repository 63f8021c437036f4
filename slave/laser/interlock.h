// SPDX-License-Identifier: Apache-2.0
// May the beam be on? Laser off is the answer to every doubt; the first reason that forbids it is said aloud.
#pragma once

#include "common/geometry/corridor.h"
#include "common/protocol/messages.h"

namespace telekerf::laser {

struct InterlockSettings {
  double corridor_m = geometry::kCorridorHalfWidth_m;
  double reaction_s = 0.003;            ///< the beam may run on this long after the decision
  double measurement_m = 20e-6;         ///< allowance for what the sensors do not see
  double max_tracking_error_m = 50e-6;  ///< tool to where the master wants it, at the tick that is applied
  double max_offset_m = 2e-6;  ///< left of the way back to the master's motion, after an approach or a gap
};

struct InterlockInputs {
  bool stopped = false;
  bool contour_known = false;  ///< and the same one that the master works on
  bool engaged = false;
  bool fresh = false;  ///< the sample being applied really came, and recently
  bool inside_workspace = false;
  double contour_distance_m = 0.0;  ///< measured tool to the contour, in plane
  double speed_m_per_s = 0.0;
  double tracking_error_m = 0.0;
  double offset_m = 0.0;
};

/// Pure judgement, made anew at every control step.
inline Interlock evaluate_interlock(const InterlockInputs& now, const InterlockSettings& settings) noexcept {
  if (now.stopped) return Interlock::kStopped;
  if (!now.contour_known) return Interlock::kNoContour;
  if (!now.engaged) return Interlock::kNotEngaged;
  if (!now.fresh) return Interlock::kStale;
  if (!now.inside_workspace) return Interlock::kOutsideWorkspace;
  const double reach_m = now.speed_m_per_s * settings.reaction_s + settings.measurement_m;
  // Written so that a NaN forbids.
  if (!(now.contour_distance_m + reach_m < settings.corridor_m)) return Interlock::kOutsideCorridor;
  if (!(now.offset_m < settings.max_offset_m)) return Interlock::kTracking;
  if (!(now.tracking_error_m < settings.max_tracking_error_m)) return Interlock::kTracking;
  return Interlock::kReady;
}

}  // namespace telekerf::laser
