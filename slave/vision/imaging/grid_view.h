// SPDX-License-Identifier: Apache-2.0
// What a picture of the printed grid (dark dots on white, square lattice) says: size of a pixel, distortion,
// light.
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace telekerf::imaging {

struct GridView {
  double metres_per_pixel = 0.0;  ///< in the picture's middle
  double distortion = 0.0;        ///< k of ImagingModel
  std::array<double, 4> flat_field{};
  double residual_px = 0.0;  ///< rms of the dots off the lattice
  int dots = 0;
};

/// Middles of the dots, sub-pixel; dots at the picture's edge are left out.
std::vector<cv::Point2d> dots_in(const cv::Mat& grey);

/// `grey`: 8 bits, in focus; `pitch_m`: from dot to dot. The error is one sentence: no grid.
tl::expected<GridView, std::string> measure_grid(const cv::Mat& grey, double pitch_m);

}  // namespace telekerf::imaging
