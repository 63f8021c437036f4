// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/cut_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/reporting/run_lookup.h"
#include "common/workpiece/mark_picture.h"

namespace telekerf::reporting {

cv::Mat draw_cut(const RunRecord& record) {
  double reach_m = 1e-3;
  for (const auto& point : record.contour_m) {
    reach_m = std::max({reach_m, std::abs(point[0]), std::abs(point[1])});
  }
  constexpr int kPixels = 1200;
  constexpr double kSpotRadius_m = 60e-6;
  workpiece::Workpiece workpiece({.half_width_m = 1.2 * reach_m, .pixels = kPixels}, workpiece::kWood);
  const double dt_s = control_period_s(record);
  for (const auto& row : record.slave) {
    if (row.laser_w > 0.0) workpiece.absorb(in_plane(row.tool_m), row.laser_w * dt_s, kSpotRadius_m);
  }

  const workpiece::Material& wood = workpiece.material();
  const double full_j = 4.0 * workpiece.pixel_m() * workpiece.pixel_m() * 1e6;  // 4 J/mm^2 chars fully
  cv::Mat picture = workpiece::mark_picture(workpiece::burnt_fraction(workpiece.energy_j(), full_j), wood);

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

  workpiece::draw_scale_bar(picture, workpiece.pixel_m(), workpiece::ink_of(wood));
  return picture;
}

}  // namespace telekerf::reporting
