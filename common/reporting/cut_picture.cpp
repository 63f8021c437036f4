// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/cut_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/reporting/run_lookup.h"
#include "slave/laser/mark_picture.h"
#include "slave/laser/workpiece.h"

namespace telekerf::reporting {

cv::Mat draw_cut(const RunRecord& record) {
  double reach_m = 1e-3;
  for (const auto& point : record.contour_m) {
    reach_m = std::max({reach_m, std::abs(point[0]), std::abs(point[1])});
  }
  constexpr int kPixels = 1200;
  laser::Workpiece workpiece({.half_width_m = 1.2 * reach_m, .pixels = kPixels, .spot_radius_m = 60e-6});
  const double dt_s = control_period_s(record);
  for (const auto& row : record.slave) {
    if (row.laser_w > 0.0) workpiece.expose(in_plane(row.tool_m), row.laser_w * dt_s);
  }

  const laser::Material wood = laser::material("wood");
  const double full_j = 4.0 * workpiece.pixel_m() * workpiece.pixel_m() * 1e6;  // 4 J/mm^2 chars fully
  cv::Mat burnt;
  cv::exp(workpiece.energy_j() * (-3.0 / full_j), burnt);
  burnt = 1.0 - burnt;
  cv::Mat picture = laser::mark_picture(burnt, wood);

  constexpr int kShift = 4;
  const auto pixel = [&](const Vec2& point) {
    const cv::Point2d p = workpiece.pixel_of(point);
    return cv::Point(static_cast<int>(std::lround(p.x * (1 << kShift))),
                     static_cast<int>(std::lround(p.y * (1 << kShift))));
  };
  std::vector<cv::Point> path;
  const auto stroke = [&](const cv::Scalar& colour, bool closed) {
    if (path.size() > 1) cv::polylines(picture, path, closed, colour, 1, cv::LINE_AA, kShift);
    path.clear();
  };
  for (const auto& row : record.slave) {
    if (row.laser_w > 0.0) {
      stroke({140, 130, 120}, false);
    } else {
      path.push_back(pixel(in_plane(row.tool_m)));
    }
  }
  stroke({140, 130, 120}, false);
  for (const auto& point : record.contour_m) path.push_back(pixel(point));
  stroke({200, 110, 30}, record.contour_closed);

  laser::draw_scale_bar(picture, workpiece.pixel_m(), laser::ink_of(wood));
  return picture;
}

}  // namespace telekerf::reporting
