// SPDX-License-Identifier: Apache-2.0
// The workpiece under the beam: a square raster in which light leaves its joules and digs.
#pragma once

#include <opencv2/core.hpp>

#include "common/runtime/vectors.h"
#include "common/workpiece/material.h"

namespace telekerf::workpiece {

struct WorkpieceSettings {
  Vec2 centre_m = Vec2::Zero();
  double half_width_m = 0.02;  ///< the raster covers a square about the centre
  int pixels = 1000;           ///< a side
};

/// Pixels a side for pixels of about that size; at least 16, at most 8000.
int pixels_for(double half_width_m, double pixel_m) noexcept;

/// Workpiece frame: x to the right, y upwards; row 0 of the rasters is at the top (largest y). A raster that
/// nothing has touched costs no memory.
class Workpiece {
 public:
  Workpiece(const WorkpieceSettings& settings, Material material);

  /// The beam stood at `at_m` for a while and left `energy_j` there: a Gaussian spot of this 1/e^2 radius,
  /// all of whose joules are kept. Off the raster, or across its edge, they are only counted.
  void absorb(const Vec2& at_m, double energy_j, double radius_m);
  /// One pulse digs as its fluence and the material say, no deeper than the material is thick.
  void ablate(const Vec2& at_m, double energy_j, double radius_m);

  cv::Mat energy_j() const;                            ///< CV_32F, of each pixel, by absorb()
  cv::Mat depth_m() const;                             ///< CV_32F, by ablate()
  double depth_m(const Vec2& point_m) const noexcept;  ///< bilinear, 0 off the raster
  double energy_off_raster_j() const noexcept { return off_raster_j_; }

  bool covers(const Vec2& point_m) const noexcept {
    return (point_m - settings_.centre_m).cwiseAbs().maxCoeff() <= settings_.half_width_m;
  }
  /// Column and row of a point; pixel centres have whole coordinates.
  cv::Point2d pixel_of(const Vec2& point_m) const noexcept;
  double pixel_m() const noexcept { return 2.0 * settings_.half_width_m / settings_.pixels; }
  const Material& material() const noexcept { return material_; }

 private:
  WorkpieceSettings settings_;
  Material material_;
  cv::Mat energy_, depth_;
  double off_raster_j_ = 0.0;
};

}  // namespace telekerf::workpiece
