// SPDX-License-Identifier: Apache-2.0
// What is known of an imaging unit, by its maker or by calibration: optics, scale and ridge over
// magnification (figures 7.10 to 7.14), distortion, flat field.
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>

#include "slave/vision/imaging/optics.h"
#include "slave/vision/imaging/region_sums.h"

namespace telekerf::imaging {

/// Both couplings are functions of s = magnification axis / its travel, 0..1.
struct ImagingModel {
  Optics optics;
  double magnification_travel_m = 0.08;
  double focus_travel_m = 0.03;
  /// ln(metres per pixel) in focus = l0 + l1 s + l2 s^2 + l3 s^3: 0.025 mm a pixel at the one end, 0.010 at
  /// the other.
  std::array<double, 4> log_scale{-10.5966, -0.9163, 0.0, 0.0};
  /// A metre of focus away from the ridge makes a pixel this share larger: focus shifts the scale.
  double focus_scale_per_m = 1.5;
  /// Focus axis where the picture is sharp: r0 + r1 s + r2 s^2: magnification shifts the focus.
  std::array<double, 3> ridge_m{0.013, 0.006, -0.003};
  /// Radial: a point at r from the picture's middle is seen at r (1 + k r^2), r in half widths.
  double distortion = 0.0;
  /// Light at (x, y) from the middle, in half widths: 1 + f0 x + f1 y + f2 r^2 + f3 r^4.
  std::array<double, 4> flat_field{0.0, 0.0, 0.0, 0.0};

  double best_focus_m(double magnification_axis_m) const noexcept;
  double metres_per_pixel(const AxisPositions& axes) const noexcept;
  /// In focus.
  double magnification(double magnification_axis_m) const noexcept;
  double depth_of_field_m(double magnification_axis_m) const noexcept;
  /// Share of the light at a pixel of a picture of this size.
  double light(double x_px, double y_px, const cv::Size& picture) const noexcept;
};

/// Variance of the light within each tile of a region of a picture, over the square of its mean.
std::array<double, kTiles> flat_within(const ImagingModel& model, const cv::Size& picture,
                                       const cv::Rect& region);

/// The picture as it would be without distortion and under even light; of the depth and the channels that it
/// has.
class PictureCorrection {
 public:
  explicit PictureCorrection(const ImagingModel& model) : model_(model) {}
  cv::Mat apply(const cv::Mat& picture);
  /// Nothing is to be corrected.
  bool idle() const noexcept;

 private:
  void prepare(const cv::Size& size);

  ImagingModel model_;
  cv::Mat from_x_;
  cv::Mat from_y_;
  cv::Mat gain_;
};

}  // namespace telekerf::imaging
