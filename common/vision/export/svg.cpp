// SPDX-License-Identifier: Apache-2.0
#include "common/vision/export/svg.h"

#include <fmt/format.h>

#include <iterator>
#include <vector>

namespace telekerf::vision {

std::string to_svg(std::span<const geometry::Polyline> contours) {
  std::vector<Vec2> all;
  for (const auto& line : contours) all.insert(all.end(), line.points_m.begin(), line.points_m.end());
  const geometry::Box box = geometry::bounding_box(all);
  const double margin = 1.0;
  const Vec2 size = 1e3 * box.size() + Vec2(2 * margin, 2 * margin);
  const auto place = [&](const Vec2& p) {
    return Vec2(1e3 * (p.x() - box.min.x()) + margin, 1e3 * (box.max.y() - p.y()) + margin);
  };
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.6f}mm\" height=\"{1:.6f}mm\" viewBox=\"0 0 "
      "{0:.6f} {1:.6f}\">\n",
      size.x(), size.y());
  for (const auto& line : contours) {
    out += "<path fill=\"none\" stroke=\"black\" stroke-width=\"0.1\" d=\"";
    char command = 'M';
    for (const Vec2& p : line.points_m) {
      const Vec2 at = place(p);
      fmt::format_to(std::back_inserter(out), "{}{:.6f} {:.6f} ", command, at.x(), at.y());
      command = 'L';
    }
    out += line.closed ? "Z\"/>\n" : "\"/>\n";
  }
  return out + "</svg>\n";
}

}  // namespace telekerf::vision
