// SPDX-License-Identifier: Apache-2.0
#include "common/vision/paper.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/vision/raster/grey_plane.h"
#include "common/vision/raster/sheet.h"

namespace telekerf::vision {
namespace {

/// Shorter and longer side, metres.
std::pair<double, double> sides_of(Paper paper) {
  switch (paper) {
    case Paper::kA5:
      return {0.148, 0.210};
    case Paper::kLetter:
      return {0.2159, 0.2794};
    case Paper::kNone:
    case Paper::kA4:
      break;
  }
  return {0.210, 0.297};
}

}  // namespace

Vec2 FlatSheet::to_sheet(const Vec2& px) const {
  const cv::Vec3d q = from_picture * cv::Vec3d(px.x(), px.y(), 1.0);
  return Vec2(q[0] / q[2], q[1] / q[2]);
}

tl::expected<FlatSheet, std::string> flat_sheet(const cv::Mat& picture, Paper paper) {
  const auto grey = grey_plane(picture);
  if (!grey) return tl::unexpected(grey.error());
  const auto sheet = sheet_in(*grey);
  if (!sheet || sheet->corners.size() != 4) {
    return tl::unexpected(
        fmt::format("--paper {}: no light sheet with all four corners is seen on a darker ground; take the "
                    "picture so that the "
                    "whole sheet shows, or give --width-mm instead",
                    kPapers.word(paper)));
  }
  const auto& c = sheet->corners;
  const double across = 0.5 * ((c[1] - c[0]).norm() + (c[2] - c[3]).norm());
  const double down = 0.5 * ((c[3] - c[0]).norm() + (c[2] - c[1]).norm());
  const auto [shorter, longer] = sides_of(paper);
  const double width_m = across > down ? longer : shorter;
  const double height_m = across > down ? shorter : longer;
  FlatSheet out;
  out.metres_per_pixel = longer / std::max(across, down);
  const int width = static_cast<int>(std::lround(width_m / out.metres_per_pixel));
  const int height = static_cast<int>(std::lround(height_m / out.metres_per_pixel));
  cv::Mat flat = rectified(picture, c, width, height);
  // The sheet's rim shows a little of the desk.
  const int rim = std::max(3, std::min(width, height) / 80);
  flat = flat(cv::Rect(rim, rim, width - 2 * rim, height - 2 * rim));
  cv::copyMakeBorder(flat, out.picture, rim, rim, rim, rim, cv::BORDER_REPLICATE);
  std::vector<cv::Point2f> from;
  for (const Vec2& p : c) from.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  const auto w = static_cast<float>(width) - 0.5F;
  const auto h = static_cast<float>(height) - 0.5F;
  const std::vector<cv::Point2f> to{{-0.5F, -0.5F}, {w, -0.5F}, {w, h}, {-0.5F, h}};
  out.from_picture = cv::Matx33d(cv::getPerspectiveTransform(from, to));
  return out;
}

}  // namespace telekerf::vision
