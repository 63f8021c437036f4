// SPDX-License-Identifier: Apache-2.0
// Drawings with a known truth, for the shipped pictures and for the tests.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/polyline.h"

namespace telekerf::drawing {

/// The ideal lines in pixels (pixel centres at whole numbers, y downwards), in drawing order.
struct Drawing {
  std::vector<geometry::Polyline> lines_px;
  bool filled = false;  ///< closed lines bound a region (even-odd), otherwise each line is a pen stroke
  double pen_px = 5.0;  ///< width of the stroke
};

/// Names: line, circle, figure-8, spiral, heart, gear, cam, octagon, letter-e, letter-s, script-e, flange,
/// blob.
std::vector<std::string> names();
/// The drawing fitted into a picture of this size.
std::optional<Drawing> by_name(std::string_view name, int width_px = 640, int height_px = 480);
/// The drawing turned about `centre_px` by an angle, magnified and moved.
Drawing transformed(const Drawing& drawing, double angle_rad, double gain, const Vec2& centre_px,
                    const Vec2& shift_px);

}  // namespace telekerf::drawing
