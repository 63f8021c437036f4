// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/workpiece.h"

#include <algorithm>
#include <cmath>

namespace telekerf::laser {

Workpiece::Workpiece(const WorkpieceSettings& settings)
    : settings_(settings), energy_(cv::Mat::zeros(settings.pixels, settings.pixels, CV_32F)) {}

cv::Point2d Workpiece::pixel_of(const Vec2& point_m) const {
  const double scale = 1.0 / pixel_m();
  const double middle = 0.5 * (settings_.pixels - 1);
  return {middle + scale * point_m.x(), middle - scale * point_m.y()};
}

void Workpiece::expose(const Vec2& tool_m, double energy_j) noexcept {
  const cv::Point2d centre = pixel_of(tool_m);
  const double radius_px = std::max(settings_.spot_radius_m / pixel_m(), 0.4);
  const int reach = static_cast<int>(std::ceil(2.0 * radius_px)) + 1;
  const int column = static_cast<int>(std::lround(centre.x));
  const int row = static_cast<int>(std::lround(centre.y));
  if (column < reach || row < reach || column >= settings_.pixels - reach ||
      row >= settings_.pixels - reach) {
    outside_j_ += energy_j;
    return;
  }
  const auto weight = [&](int r, int c) {
    const double dx = c - centre.x;
    const double dy = r - centre.y;
    return std::exp(-2.0 * (dx * dx + dy * dy) / (radius_px * radius_px));
  };
  double sum = 0.0;
  for (int r = row - reach; r <= row + reach; ++r) {
    for (int c = column - reach; c <= column + reach; ++c) sum += weight(r, c);
  }
  for (int r = row - reach; r <= row + reach; ++r) {
    for (int c = column - reach; c <= column + reach; ++c) {
      energy_.at<float>(r, c) += static_cast<float>(energy_j * weight(r, c) / sum);
    }
  }
}

}  // namespace telekerf::laser
