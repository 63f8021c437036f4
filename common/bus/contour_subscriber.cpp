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

bool refuses_contour(const EventMessage& answer, const std::string& own_role, std::uint32_t id) {
  const std::size_t colon = answer.text.find(": ");
  if (answer.value == 0.0 || colon == std::string::npos || answer.text.substr(0, colon) == own_role)
    return false;
  const std::string_view why = std::string_view(answer.text).substr(colon + 2);
  const std::string contour = fmt::format("contour {} ", id);  // see title_of() and take()
  return why.starts_with(contour) || why.starts_with("no " + contour);
}

}  // namespace telekerf
