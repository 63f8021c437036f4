// SPDX-License-Identifier: Apache-2.0
// Contours as files: CSV, SVG, G-code, and a picture with the path drawn over it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "common/geometry/polyline.h"
#include "common/vision/load.h"

namespace telekerf::vision {

/// `x_m,y_m` and one line a point, enough digits to come back as the same number.
std::string to_csv(const geometry::Polyline& line);
/// The points of a CSV file with two columns; one heading line is allowed. The error names the line.
tl::expected<std::vector<Vec2>, std::string> points_from_csv(std::string_view text);

/// True-size SVG in millimetres, y turned down again.
std::string to_svg(std::span<const geometry::Polyline> contours);

struct MachiningSettings {
  double cutting_speed_m_per_s = 8e-3;
  double travel_speed_m_per_s = 0.05;
  double overlap_m = 0.2e-3;  ///< a closed cut runs on this far beyond its start, so that it is really closed
  int full_power = 1000;      ///< S word
  double shortest_segment_m = 5e-6;  ///< controllers choke on shorter ones
  double tolerance_m = 2e-6;         ///< of leaving points out
};
struct GCode {
  std::string text;
  double cutting_time_s = 0.0;  ///< at constant speeds; corners take a little longer
  double travel_m = 0.0;
};
/// Millimetres, inner contours first, short travel. M4 lets the controller hold the laser's power
/// proportional to the true speed, so that corners and ends get no more energy than the rest; the beam is off
/// on the way.
GCode to_gcode(std::span<const geometry::Polyline> contours, const MachiningSettings& settings = {});

/// The picture (or, for a vector drawing, a white page) with all contours, the selected one in red, its start
/// in green, its direction as a purple dot some way on.
cv::Mat overlay_of(const Loaded& loaded);

}  // namespace telekerf::vision
