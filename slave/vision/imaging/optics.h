// SPDX-License-Identifier: Apache-2.0
// What the optics make of defocus: depth of field, and blur on the sensor.
#pragma once

#include <cmath>

namespace telekerf::imaging {

/// Where the two axes stand, metres of travel from their lower ends.
struct AxisPositions {
  double magnification_m = 0.0;
  double focus_m = 0.0;
};

/// A microscope or macro lens before its sensor.
struct Optics {
  double wavelength_m = 0.55e-6;
  double numerical_aperture = 0.05;
  double refractive_index = 1.0;
  double pixel_m = 3e-6;     ///< pitch of the sensor's pixels
  double sharpest_px = 0.6;  ///< standard deviation of the blur that is left in focus

  /// lambda n / NA^2 + n e / (M NA), metres at the object.
  double depth_of_field_m(double magnification) const noexcept {
    const double na = numerical_aperture;
    return refractive_index * (wavelength_m / (na * na) + pixel_m / (magnification * na));
  }
  /// Of the geometric disc, whose radius is z NA / n: half of it, pixels of blur a depth of field.
  double blur_px_per_dof(double magnification) const noexcept {
    return 0.5 * (1.0 + wavelength_m * magnification / (numerical_aperture * pixel_m));
  }
  /// Standard deviation of the blur, pixels.
  double blur_px(double defocus_dof, double magnification) const noexcept {
    return std::hypot(sharpest_px, blur_px_per_dof(magnification) * defocus_dof);
  }
  double magnification(double metres_per_pixel) const noexcept { return pixel_m / metres_per_pixel; }
};

}  // namespace telekerf::imaging
