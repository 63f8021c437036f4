// SPDX-License-Identifier: Apache-2.0
// Contours as G-code.
#pragma once

#include <span>
#include <string>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

struct GCodeSettings {
  double cutting_speed_m_per_s = 8e-3;
  double travel_speed_m_per_s = 0.05;
  double overlap_m = 0.2e-3;  ///< a closed cut runs on this far beyond its start, so that it is really closed
  int full_power = 1000;      ///< S word
  int passes = 1;             ///< over each contour, one after the other
  double min_segment_m = 5e-6;  ///< controllers choke on shorter ones
  double tolerance_m = 2e-6;    ///< of leaving points out
};
struct GCode {
  std::string text;
  double cutting_time_s = 0.0;  ///< at constant speeds; corners take a little longer
  double travel_m = 0.0;
};
/// Millimetres, inner contours first, short travel. M4 lets the controller hold the laser's power
/// proportional to the true speed, so that corners and ends get no more energy than the rest; the beam is off
/// on the way.
GCode to_gcode(std::span<const geometry::Polyline> contours, const GCodeSettings& settings = {});

}  // namespace telekerf::vision
