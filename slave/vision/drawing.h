// SPDX-License-Identifier: Apache-2.0
// Drawings with a known truth, and the way a camera would see them: for the shipped pictures and for the
// tests.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
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

/// What the paper and the camera add.
struct Look {
  int width_px = 640;
  int height_px = 480;
  double paper = 228.0;  ///< grey level of the background
  double ink = 40.0;     ///< grey level of the drawing
  double blur_px = 0.8;  ///< sigma of the lens
  double noise = 4.0;    ///< sigma in grey levels
  double shading = 0.0;  ///< how much darker the far corner is, grey levels
  double grain = 0.0;    ///< slow unevenness of the paper, grey levels
  std::uint64_t seed = 1;
};

/// Names: line, circle, figure-8, spiral, heart, gear, cam, octagon, letter-e, letter-s, script-e, flange,
/// blob.
std::vector<std::string> names();
/// The drawing fitted into a picture of this size.
std::optional<Drawing> by_name(std::string_view name, int width_px = 640, int height_px = 480);
/// The drawing turned about `centre_px` by an angle, magnified and moved.
Drawing transformed(const Drawing& drawing, double angle_rad, double gain, const Vec2& centre_px,
                    const Vec2& shift_px);

/// One grey picture (CV_8U), anti-aliased by sampling each pixel 6 x 6 times.
cv::Mat render(const Drawing& drawing, const Look& look);

}  // namespace telekerf::drawing
