// SPDX-License-Identifier: Apache-2.0
// A microscope in the computer: what its sensor shows of a texture when the axes stand where they stand.
#pragma once

#include <cstdint>
#include <map>
#include <opencv2/core.hpp>

#include "slave/vision/imaging/imaging_model.h"

namespace telekerf::imaging {

/// The truth of the simulated unit.
ImagingModel simulated_model();

struct MicroscopeSettings {
  /// The truth; a third of the light is lost in the corners.
  ImagingModel model = simulated_model();
  /// What no quadratic ridge holds: this times s (1 - s) (1 - 2 s) is added to it, m.
  double ridge_cubic_m = 0.003;
  cv::Size picture{128, 128};
  double read_noise = 2.0;         ///< grey levels, rms
  double shot_noise = 2.0;         ///< grey levels at white, rms; its variance goes with the light
  double exposure_per_dof = 0.01;  ///< the light changes by this share a depth of field
  double exposure_per_s = 0.001;   ///< and with time
  int dust_specks = 0;             ///< dark, on a layer of its own
  double dust_dof = 6.0;           ///< where that layer lies, depths of field from the object
  std::uint64_t seed = 1;
};

/// The object under it; its texture stays. The texture repeats mirrored beyond its edges.
struct Object {
  cv::Mat texture;                ///< CV_32F, grey levels under full light
  double metres_per_texel = 0.0;  ///< size of one
  double height_m = 0.0;          ///< towards the lens: the focus axis must be that much higher
  double x_m = 0.0;               ///< of its middle, right
  double y_m = 0.0;               ///< and down in the picture
};

/// Same settings, seed and calls: same pictures, bit by bit.
class SimulatedMicroscope {
 public:
  SimulatedMicroscope(const MicroscopeSettings& settings, Object object);

  Object& object() noexcept { return object_; }
  const MicroscopeSettings& settings() const noexcept { return settings_; }

  /// An exposure with the optics at `axes` (behind any backlash), at `time_s`: 8-bit grey levels.
  cv::Mat picture(const AxisPositions& axes, double time_s);

  /// The truth, for judges.
  double best_focus_m(double magnification_axis_m) const noexcept;
  double defocus_dof(const AxisPositions& axes) const noexcept;
  double metres_per_pixel(const AxisPositions& axes) const noexcept;

 private:
  cv::Mat sharp(double metres_per_pixel);
  /// The texture as pixels of `texels` texels gather it.
  const cv::Mat& gathered(double texels);
  void prepare_places();
  const cv::Mat& light();
  const cv::Mat& dust();

  MicroscopeSettings settings_;
  Object object_;
  cv::RNG random_;
  std::map<int, cv::Mat> gathered_;  ///< by step of size
  cv::Mat place_x_;                  ///< of each pixel from the middle, without distortion, pixels
  cv::Mat place_y_;
  cv::Mat light_;
  cv::Mat dust_;
};

}  // namespace telekerf::imaging
