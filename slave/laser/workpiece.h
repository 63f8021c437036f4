// SPDX-License-Identifier: Apache-2.0
// The workpiece as a raster of absorbed laser energy.
#pragma once

#include <opencv2/core.hpp>

#include "common/protocol/messages.h"

namespace telekerf::laser {

struct WorkpieceSettings {
  double half_width_m = 0.02;    ///< the raster covers a square about the workspace centre
  int pixels = 1000;             ///< a side
  double spot_radius_m = 30e-6;  ///< 1/e^2 radius of the beam
};

/// Accumulates the energy that the laser leaves, as a Gaussian spot, in joules per pixel. x to the right, y
/// upwards.
class Workpiece {
 public:
  explicit Workpiece(const WorkpieceSettings& settings);

  /// The beam stood at `tool_m` (workpiece frame) and left `energy_j`.
  void expose(const Vec2& tool_m, double energy_j) noexcept;

  const cv::Mat& energy_j() const { return energy_; }  ///< CV_32F, row 0 at the top (largest y)
  double pixel_m() const { return 2.0 * settings_.half_width_m / settings_.pixels; }
  /// Pixel coordinates (column, row) of a point; pixel centres have whole coordinates.
  cv::Point2d pixel_of(const Vec2& point_m) const;
  double outside_raster_j() const { return outside_j_; }

 private:
  WorkpieceSettings settings_;
  cv::Mat energy_;
  double outside_j_ = 0.0;
};

}  // namespace telekerf::laser
