// SPDX-License-Identifier: Apache-2.0
#include "common/vision/export/overlay.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "common/vision/raster/grey_plane.h"

namespace telekerf::vision {

cv::Mat overlay_of(const LoadedContours& loaded) {
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
    if (points.empty()) continue;
    // Its number beside its first point.
    const cv::Point place(points.front().x / (1 << kShift) + 4 * thickness,
                          points.front().y / (1 << kShift) - 4 * thickness);
    cv::putText(out, std::to_string(k), place, cv::FONT_HERSHEY_SIMPLEX, 0.45 * thickness, colour, thickness,
                cv::LINE_AA);
    if (!chosen) continue;
    const int radius = (3 + thickness) << kShift;
    cv::circle(out, points[points.size() / 16], radius / 2, cv::Scalar(180, 0, 180), -1, cv::LINE_AA, kShift);
    cv::circle(out, points.front(), radius, cv::Scalar(0, 160, 0), -1, cv::LINE_AA, kShift);
  }
  return out;
}

}  // namespace telekerf::vision
