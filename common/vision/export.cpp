// SPDX-License-Identifier: Apache-2.0
#include "common/vision/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <opencv2/imgproc.hpp>

#include "common/geometry/cutting_order.h"
#include "common/vision/raster/picture.h"
#include "common/vision/vector/number.h"

namespace telekerf::vision {

std::string to_csv(const geometry::Polyline& line) {
  std::string out = "x_m,y_m\n";
  for (const Vec2& p : line.points_m) fmt::format_to(std::back_inserter(out), "{},{}\n", p.x(), p.y());
  return out;
}

tl::expected<std::vector<Vec2>, std::string> points_from_csv(std::string_view text) {
  std::vector<Vec2> out;
  std::size_t number = 0;
  while (!text.empty()) {
    const auto end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    ++number;
    std::string_view rest = line;
    skip_separators(rest);
    if (rest.empty() || rest.front() == '#') continue;
    const auto x = take_number(rest);
    const auto y = x ? take_number(rest) : std::nullopt;
    while (!rest.empty() && (rest.back() == '\r' || rest.back() == ' ')) rest.remove_suffix(1);
    const bool heading = number == 1 && !x && line.find_first_of("0123456789") == std::string_view::npos &&
                         line.find("nan") == std::string_view::npos &&
                         line.find("inf") == std::string_view::npos;
    if (heading) continue;
    if (!y || !rest.empty()) {
      return tl::unexpected(fmt::format("line {}: \"{:.40}\" is not two finite numbers x,y", number, line));
    }
    out.emplace_back(*x, *y);
  }
  if (out.empty()) return tl::unexpected<std::string>("there is no point in it");
  return out;
}

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

GCode to_gcode(std::span<const geometry::Polyline> contours, const MachiningSettings& settings) {
  const std::vector<geometry::Polyline> all(contours.begin(), contours.end());
  const geometry::CuttingOrder cut = geometry::cutting_order(all);
  GCode out;
  out.travel_m = cut.travel_m;
  double length = 0.0;
  std::vector<Vec2> points;
  for (const auto& line : all) {
    length += geometry::length_m(line) + (line.closed ? settings.overlap_m : 0.0);
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
        geometry::without_duplicates(all[index], settings.shortest_segment_m), settings.tolerance_m);
    if (line.points_m.empty()) continue;
    const auto go = [&](const char* word, const Vec2& p) {
      fmt::format_to(to, "{} X{:.4f} Y{:.4f}", word, 1e3 * p.x(), 1e3 * p.y());
    };
    go("G0", line.points_m.front());
    fmt::format_to(to, "\nM4 S{}\nF{:.1f}\n", settings.full_power, 6e4 * settings.cutting_speed_m_per_s);
    for (std::size_t i = 1; i < line.size(); ++i) {
      go("G1", line.points_m[i]);
      out.text += '\n';
    }
    if (line.closed) {
      double left = settings.overlap_m;
      go("G1", line.points_m.front());
      out.text += '\n';
      for (std::size_t i = 0; i < line.segments() && left > 0.0; ++i) {
        const Vec2 step = line.end_of(i) - line.start_of(i);
        const double share = std::min(1.0, left / step.norm());
        go("G1", line.start_of(i) + share * step);
        out.text += '\n';
        left -= step.norm();
      }
    }
    out.text += "M5\n";
  }
  out.text += "G0 X0 Y0\nM2\n";
  return out;
}

cv::Mat overlay_of(const Loaded& loaded) {
  cv::Mat out;
  Scale scale = loaded.scale;
  if (loaded.picture.empty()) {
    std::vector<Vec2> all;
    for (const auto& line : loaded.contours)
      all.insert(all.end(), line.points_m.begin(), line.points_m.end());
    const geometry::Box box = geometry::bounding_box(all);
    const double gain = 760.0 / std::max({box.size().x(), box.size().y(), 1e-9});
    scale.metres_per_pixel = 1.0 / gain;
    scale.anchor_px = Vec2(20.0 - gain * box.min.x(), 20.0 + gain * box.max.y());
    out = cv::Mat(static_cast<int>(gain * box.size().y()) + 40, static_cast<int>(gain * box.size().x()) + 40,
                  CV_8UC3, cv::Scalar(255, 255, 255));
  } else if (const auto grey = grey_plane(loaded.picture)) {
    cv::cvtColor(*grey, out, cv::COLOR_GRAY2BGR);
    out = 0.5 * out + cv::Scalar(110, 110, 110);  // pale, so that the path shows
  } else {
    return {};
  }
  constexpr int kShift = 4;
  const int thickness = std::max(1, out.cols / 800);
  const auto pixel = [&](const Vec2& m) {
    const Vec2 p = scale.to_picture(m) * (1 << kShift);
    return cv::Point(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
  };
  for (std::size_t k = loaded.contours.size(); k-- > 0;) {
    std::vector<cv::Point> points;
    for (const Vec2& p : loaded.contours[k].points_m) points.push_back(pixel(p));
    const bool chosen = k == loaded.selected;
    const cv::Scalar colour = chosen ? cv::Scalar(0, 0, 220) : cv::Scalar(200, 120, 0);
    cv::polylines(out, points, loaded.contours[k].closed, colour, thickness, cv::LINE_AA, kShift);
    if (!chosen || points.empty()) continue;
    const int radius = (3 + thickness) << kShift;
    cv::circle(out, points[points.size() / 16], radius / 2, cv::Scalar(180, 0, 180), -1, cv::LINE_AA, kShift);
    cv::circle(out, points.front(), radius, cv::Scalar(0, 160, 0), -1, cv::LINE_AA, kShift);
  }
  return out;
}

}  // namespace telekerf::vision
