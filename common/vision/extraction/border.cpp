// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/border.h"

#include <cstddef>
#include <vector>

#include "common/vision/extraction/tangents.h"

namespace telekerf::vision {

PixelContour on_border(const Field& field, const Route& route) {
  constexpr double kMaxShift_px = 4.0;
  constexpr double kStep_px = 0.5;
  PixelContour out;
  out.closed = route.closed;
  out.points_px = geometry::resampled({route.points_px, route.closed}, 1.0).points_m;
  smooth_and_resample(out, 1.0);
  const std::vector<Vec2> tangents = tangents_of(out.points_px, out.closed, 2);
  for (std::size_t i = 0; i < out.points_px.size(); ++i) {
    Vec2& p = out.points_px[i];
    const Vec2 normal(-tangents[i].y(), tangents[i].x());
    const double here = field.value(p);
    const double inwards = here > 0.0 ? 1.0 : -1.0;
    for (const double side : {1.0, -1.0}) {  // towards the other side of the border, whichever way that is
      double before = here;
      double s = kStep_px;
      double value = field.value(p + side * s * normal);
      while (s < kMaxShift_px && value * inwards > 0.0) {
        before = value;
        s += kStep_px;
        value = field.value(p + side * s * normal);
      }
      if (value * inwards > 0.0) continue;
      p += side * (s - kStep_px * value / (value - before)) * normal;
      break;
    }
  }
  return out;
}

}  // namespace telekerf::vision
