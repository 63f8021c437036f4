// SPDX-License-Identifier: Apache-2.0
#include "common/vision/export/gcode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

#include "common/geometry/cutting_order.h"

namespace telekerf::vision {

GCode to_gcode(std::span<const geometry::Polyline> contours, const GCodeSettings& settings) {
  const std::vector<geometry::Polyline> all(contours.begin(), contours.end());
  const geometry::CuttingOrder cut = geometry::cutting_order(all);
  GCode out;
  out.travel_m = cut.travel_m;
  double length = 0.0;
  std::vector<Vec2> points;
  for (const auto& line : all) {
    length += geometry::length_m(line) * settings.passes + (line.closed ? settings.overlap_m : 0.0);
    points.insert(points.end(), line.points_m.begin(), line.points_m.end());
  }
  out.cutting_time_s = length / settings.cutting_speed_m_per_s + cut.travel_m / settings.travel_speed_m_per_s;
  const geometry::Box box = geometry::bounding_box(points);
  auto to = std::back_inserter(out.text);
  fmt::format_to(to, "(telekerf contour: {} paths, {:.3f} x {:.3f} mm, {:.3f} mm to cut, about {:.1f} s)\n",
                 all.size(), 1e3 * box.size().x(), 1e3 * box.size().y(), 1e3 * length, out.cutting_time_s);
  fmt::format_to(to,
                 "(M4: laser power follows the speed; frame: x {:.3f} .. {:.3f}, y {:.3f} .. {:.3f} mm)\n",
                 1e3 * box.min.x(), 1e3 * box.max.x(), 1e3 * box.min.y(), 1e3 * box.max.y());
  fmt::format_to(to, "G21 G90 G17\nM5\n");
  for (const std::size_t index : cut.order) {
    const geometry::Polyline line = geometry::simplified(
        geometry::without_duplicates(all[index], settings.min_segment_m), settings.tolerance_m);
    if (line.points_m.empty()) continue;
    Vec2 at = line.points_m.front();
    const auto go = [&](const char* word, const Vec2& p) {
      fmt::format_to(to, "{} X{:.4f} Y{:.4f}", word, 1e3 * p.x(), 1e3 * p.y());
      at = p;
    };
    const auto burn = [&](const Vec2& p) {
      if ((p - at).norm() < settings.min_segment_m) return;
      go("G1", p);
      out.text += '\n';
    };
    go("G0", line.points_m.front());
    fmt::format_to(to, "\nM4 S{}\nF{:.1f}\n", settings.full_power, 6e4 * settings.cutting_speed_m_per_s);
    for (int pass = 0; pass < settings.passes; ++pass) {
      // An open line is cut there and back.
      const bool back = !line.closed && pass % 2 == 1;
      for (std::size_t i = 1; i < line.size(); ++i) burn(line.points_m[back ? line.size() - 1 - i : i]);
      if (line.closed) burn(line.points_m.front());
    }
    double left = line.closed ? settings.overlap_m : 0.0;
    for (std::size_t i = 0; i < line.segments() && left > 0.0; ++i) {
      const Vec2 step = line.end_of(i) - line.start_of(i);
      burn(line.start_of(i) + std::min(1.0, left / step.norm()) * step);
      left -= step.norm();
    }
    out.text += "M5\n";
  }
  out.text += "G0 X0 Y0\nM2\n";
  return out;
}

}  // namespace telekerf::vision
