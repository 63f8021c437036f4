// SPDX-License-Identifier: Apache-2.0
// Contours as G-code.
#pragma once

#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::vision {

struct GCodeSettings {
  double cutting_speed_m_per_s = 8e-3;
  double travel_speed_m_per_s = 0.05;
  double overlap_m = 0.2e-3;  ///< a closed cut runs on this far beyond its start, so that it is really closed
  int full_power = 1000;      ///< S word
  int passes = 1;             ///< over each contour, one after the other
  double min_segment_m = 5e-6;   ///< controllers choke on shorter ones
  double tolerance_m = 2e-6;     ///< of leaving points out
  double kerf_m = 0.0;           ///< closed contours are moved by half of it, holes inwards
  Vec2 origin_m = Vec2::Zero();  ///< the place on the workpiece that the program calls 0,0
  bool arcs = false;             ///< circular moves (G2, G3) where they reach farther than straight ones
};
struct GCode {
  std::string text;
  double cutting_time_s = 0.0;        ///< at constant speeds; corners take a little longer
  double travel_m = 0.0;              ///< beam off, from 0,0 and back there
  std::vector<std::string> warnings;  ///< what of the contours is not cut
};
/// Millimetres, inner contours first, short travel. M4 lets the controller hold the laser's power
/// proportional to the true speed, so that corners and ends get no more energy than the rest; the beam is off
/// on the way. An error, one sentence: a contour is narrower than the kerf.
tl::expected<GCode, std::string> to_gcode(std::span<const geometry::Polyline> contours,
                                          const GCodeSettings& settings = {});

}  // namespace telekerf::vision
