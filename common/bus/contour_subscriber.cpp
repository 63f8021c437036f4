// SPDX-License-Identifier: Apache-2.0
#include "common/bus/contour_subscriber.h"

#include "common/geometry/polyline.h"

namespace telekerf {

std::string title_of(const ContourMessage& message) {
  const geometry::Polyline line{message.points_m, message.closed};
  const Vec2 size_mm = geometry::bounding_box(line.points_m).size() * 1e3;
  return fmt::format("contour {} ({}, {:.1f} mm long, {:.1f} x {:.1f} mm)", message.id, message.source,
                     geometry::length_m(line) * 1e3, size_mm.x(), size_mm.y());
}

}  // namespace telekerf
