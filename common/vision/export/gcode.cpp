// SPDX-License-Identifier: Apache-2.0
#include "common/vision/export/gcode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

#include "common/geometry/cutting_order.h"
#include "common/geometry/kerf.h"
#include "common/vision/export/moves.h"

namespace telekerf::vision {

namespace {

/// The contours as the program moves along them: compensated for the kerf, seen from its origin.
tl::expected<std::vector<geometry::Polyline>, std::string> prepared(
    std::span<const geometry::Polyline> contours, const GCodeSettings& settings,
    std::vector<std::string>& warnings) {
  std::vector<geometry::Polyline> out(contours.begin(), contours.end());
  const std::vector<bool> holes = geometry::holes(out);
  for (std::size_t i = 0; i < out.size(); ++i) {
    auto moved = geometry::compensated(out[i], settings.kerf_m, holes[i]);
    if (!moved) return tl::unexpected(fmt::format("contour {}: {}", i, moved.error()));
    if (const std::string what = geometry::passed_by(out[i], *moved, settings.kerf_m); !what.empty())
      warnings.push_back(fmt::format("contour {}: {}", i, what));
    out[i] = std::move(*moved);
    for (Vec2& p : out[i].points_m) p -= settings.origin_m;
  }
  return out;
}

/// Once along the contour, back to its beginning if it is closed.
std::vector<Vec2> way_along(const geometry::Polyline& line) {
  std::vector<Vec2> out = line.points_m;
  if (line.closed) out.push_back(line.points_m.front());
  return out;
}

/// The first `length_m` of a way.
std::vector<Vec2> beginning_of(const std::vector<Vec2>& way, double length_m) {
  std::vector<Vec2> out{way.front()};
  for (std::size_t i = 1; i < way.size() && length_m > 0.0; ++i) {
    const Vec2 step = way[i] - way[i - 1];
    out.push_back(way[i - 1] + std::min(1.0, length_m / step.norm()) * step);
    length_m -= step.norm();
  }
  return out;
}

/// Writes moves, and knows where the last one ended and how far it went with the beam and without.
struct Writer {
  const GCodeSettings& settings;
  std::string text;
  Vec2 at = Vec2::Zero();
  double travel_m = 0.0;
  double cut_m = 0.0;

  void go_to(const Vec2& p) {
    fmt::format_to(std::back_inserter(text), "G0 X{:.4f} Y{:.4f}\n", 1e3 * p.x(), 1e3 * p.y());
    travel_m += (p - at).norm();
    at = p;
  }
  void burn_along(const std::vector<Vec2>& way) {
    cut_m += geometry::length_m({way, false});
    for (const Move& move : moves_along(way, settings.tolerance_m, settings.arcs)) {
      if ((move.to_m - at).norm() < settings.min_segment_m) continue;
      fmt::format_to(std::back_inserter(text), "{} X{:.4f} Y{:.4f}",
                     !move.arc        ? "G1"
                     : move.clockwise ? "G2"
                                      : "G3",
                     1e3 * move.to_m.x(), 1e3 * move.to_m.y());
      if (move.arc) {
        const Vec2 centre = move.centre_m - at;
        fmt::format_to(std::back_inserter(text), " I{:.4f} J{:.4f}", 1e3 * centre.x(), 1e3 * centre.y());
      }
      text += '\n';
      at = move.to_m;
    }
  }
};

}  // namespace

tl::expected<GCode, std::string> to_gcode(std::span<const geometry::Polyline> contours,
                                          const GCodeSettings& settings) {
  GCode out;
  const auto prepared_lines = prepared(contours, settings, out.warnings);
  if (!prepared_lines) return tl::unexpected(prepared_lines.error());
  const std::vector<geometry::Polyline>& all = *prepared_lines;
  Writer writer{settings, {}};
  std::vector<Vec2> points;
  for (const std::size_t index : geometry::cutting_order(all).order) {
    points.insert(points.end(), all[index].points_m.begin(), all[index].points_m.end());
    const geometry::Polyline line = geometry::without_duplicates(all[index], settings.min_segment_m);
    if (line.size() < 2) {
      out.warnings.push_back(fmt::format("contour {}: is smaller than a move of {:g} mm, so it is not cut",
                                         index, 1e3 * settings.min_segment_m));
      continue;
    }
    std::vector<Vec2> way = way_along(line);
    writer.go_to(way.front());
    fmt::format_to(std::back_inserter(writer.text), "M4 S{}\nF{:.1f}\n", settings.full_power,
                   6e4 * settings.cutting_speed_m_per_s);
    for (int pass = 0; pass < settings.passes; ++pass) {
      writer.burn_along(way);
      if (!line.closed) std::reverse(way.begin(), way.end());  // an open line is cut there and back
    }
    if (line.closed) writer.burn_along(beginning_of(way, settings.overlap_m));
    writer.text += "M5\n";
  }
  out.travel_m = writer.travel_m + writer.at.norm();
  out.cutting_time_s =
      writer.cut_m / settings.cutting_speed_m_per_s + out.travel_m / settings.travel_speed_m_per_s;
  const geometry::Box box = geometry::bounding_box(points);
  out.text = fmt::format(
      "(telekerf contour: {} paths, {:.3f} x {:.3f} mm, {:.3f} mm to cut, about {:.1f} s)\n"
      "(M4: laser power follows the speed; frame: x {:.3f} .. {:.3f}, y {:.3f} .. {:.3f} mm)\n",
      all.size(), 1e3 * box.size().x(), 1e3 * box.size().y(), 1e3 * writer.cut_m, out.cutting_time_s,
      1e3 * box.min.x(), 1e3 * box.max.x(), 1e3 * box.min.y(), 1e3 * box.max.y());
  // G91.1: the centres of arcs are given from where each begins.
  out.text += fmt::format("G21 G90 G17{}\nM5\n", settings.arcs ? " G91.1" : "");
  out.text += writer.text;
  out.text += "G0 X0 Y0\nM2\n";
  return out;
}

}  // namespace telekerf::vision
