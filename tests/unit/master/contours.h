// SPDX-License-Identifier: Apache-2.0
// The contours that the tests of the constraint are made on.
#pragma once

#include <cmath>

#include "common/protocol/messages.h"

namespace telekerf::master::testing {

/// Anticlockwise, from the point on the x axis.
inline ContourMessage circle(double radius_m) {
  ContourMessage contour;
  contour.id = 3;
  for (int i = 0; i < 720; ++i) {
    contour.points_m.emplace_back(radius_m * std::cos(i * M_PI / 360), radius_m * std::sin(i * M_PI / 360));
  }
  return contour;
}

inline ContourMessage figure_eight() {
  ContourMessage contour;
  for (int i = 0; i < 2000; ++i) {
    const double t = i * 2 * M_PI / 2000;
    contour.points_m.emplace_back(0.01 * std::sin(t), 0.005 * std::sin(2 * t));
  }
  return contour;
}

/// Open, along the x axis from the origin.
inline ContourMessage straight_line(double length_m) {
  ContourMessage contour;
  contour.closed = false;
  for (int i = 0; i <= 100; ++i) contour.points_m.emplace_back(length_m * i / 100, 0.0);
  return contour;
}

}  // namespace telekerf::master::testing
