// SPDX-License-Identifier: Apache-2.0
// The workpiece as a raster of depths: pulses dig, joules are counted inside and outside the corridor.
#pragma once

#include <opencv2/core.hpp>

#include "common/geometry/nearest.h"
#include "common/runtime/vectors.h"
#include "slave/laser/material.h"
#include "slave/laser/pulsed_source.h"

namespace telekerf::laser {

struct HeightMapSettings {
  Vec2 centre_m = Vec2::Zero();
  double half_width_m = 0.02;  ///< the raster covers a square about the centre
  double pixel_m = 10e-6;
};

struct EnergyStatistics {
  double inside_j = 0.0;
  double outside_j = 0.0;  ///< beyond the corridor, or off the raster
  double absorbed_j = 0.0;
  double removed_m3 = 0.0;
};

class HeightMap {
 public:
  HeightMap(const HeightMapSettings& settings, const Material& material, const PulsedSourceSettings& source);

  /// The beam moved from `from_m` to `to_m` (workpiece frame) in `dt_s` with `power_w`; pulses are where
  /// the beam is when they leave. `defocus_m`: distance of the surface from the focus. `corridor`: null, or
  /// the contour whose energy is booked within `corridor_m` to either side of it.
  void expose(const Vec2& from_m, const Vec2& to_m, double power_w, double dt_s, double defocus_m = 0.0,
              const geometry::NearestIndex* corridor = nullptr, double corridor_m = 0.5e-3);

  const cv::Mat& depth_m() const noexcept { return depth_; }  ///< CV_32F, row 0 at the top (largest y)
  const EnergyStatistics& energy() const noexcept { return energy_; }
  /// Depth at a point (bilinear), 0 off the raster.
  double depth_at(const Vec2& point_m) const noexcept;
  cv::Point2d pixel_of(const Vec2& point_m) const noexcept;
  double pixel_m() const noexcept { return settings_.pixel_m; }

  /// The mark as it looks (CV_8UC3) and the depth as a map of colours with the colours' scale beside it; both
  /// at most `pixels` wide (without that scale), with a bar of some millimetres below.
  cv::Mat picture(int pixels = 1200) const;
  cv::Mat depth_picture(int pixels = 1200) const;

 private:
  void pulse(const Vec2& at_m, double energy_j, double radius_m);
  /// The depths as pictures show them, and the size of their pixels.
  cv::Mat shown(int pixels) const;
  double shown_pixel_m(const cv::Mat& picture) const noexcept {
    return settings_.pixel_m * depth_.cols / picture.cols;
  }

  HeightMapSettings settings_;
  Material material_;
  PulsedSource source_;
  cv::Mat depth_;
  EnergyStatistics energy_;
};

}  // namespace telekerf::laser
