// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/pixel_contour.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "common/geometry/smoothing.h"

namespace telekerf::vision {

double size_px(const PixelContour& contour) {
  return geometry::bounding_box(contour.points_px).size().norm();
}

double length_px(const PixelContour& contour) {
  return geometry::length_m({contour.points_px, contour.closed});
}

void smooth_and_resample(PixelContour& contour, double sigma_px) {
  const geometry::Polyline raw{std::move(contour.points_px), contour.closed};
  geometry::Polyline even = geometry::resampled(raw, 0.5);
  const double spacing =
      geometry::length_m(even) / static_cast<double>(std::max<std::size_t>(1, even.segments()));
  if (spacing > 0.0)
    contour.noise_px = geometry::smooth_keeping_bends(even.points_m, even.closed, sigma_px / spacing);
  contour.points_px = geometry::resampled(even, 1.0).points_m;
}

}  // namespace telekerf::vision
