// SPDX-License-Identifier: Apache-2.0
#include "common/workpiece/workpiece.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace telekerf::workpiece {
namespace {

/// A Gaussian spot on the raster; lengths in pixels.
struct Spot {
  cv::Point2d centre;
  double radius;
  int reach;  ///< pixels to either side of (row, column) that it matters to
  int column = static_cast<int>(std::lround(centre.x));
  int row = static_cast<int>(std::lround(centre.y));

  double weight(int r, int c) const noexcept {
    const double dx = c - centre.x;
    const double dy = r - centre.y;
    return std::exp(-2.0 * (dx * dx + dy * dy) / (radius * radius));
  }
};

cv::Mat zeros(int side) { return cv::Mat::zeros(side, side, CV_32F); }

}  // namespace

int pixels_for(double half_width_m, double pixel_m) noexcept {
  return std::clamp(static_cast<int>(2.0 * half_width_m / pixel_m), 16, 8000);
}

Workpiece::Workpiece(const WorkpieceSettings& settings, Material material)
    : settings_(settings), material_(std::move(material)) {}

cv::Point2d Workpiece::pixel_of(const Vec2& point_m) const noexcept {
  const Vec2 p = (point_m - settings_.centre_m) / pixel_m();
  const double middle = 0.5 * (settings_.pixels - 1);
  return {middle + p.x(), middle - p.y()};
}

void Workpiece::absorb(const Vec2& at_m, double energy_j, double radius_m) {
  if (energy_.empty()) energy_ = zeros(settings_.pixels);
  const double radius = std::max(radius_m / pixel_m(), 0.4);
  const Spot spot{pixel_of(at_m), radius, static_cast<int>(std::ceil(2.0 * radius)) + 1};
  const int last = settings_.pixels - 1 - spot.reach;
  if (spot.column < spot.reach || spot.row < spot.reach || spot.column > last || spot.row > last) {
    off_raster_j_ += energy_j;
    return;
  }
  double sum = 0.0;
  for (int r = spot.row - spot.reach; r <= spot.row + spot.reach; ++r) {
    for (int c = spot.column - spot.reach; c <= spot.column + spot.reach; ++c) sum += spot.weight(r, c);
  }
  for (int r = spot.row - spot.reach; r <= spot.row + spot.reach; ++r) {
    for (int c = spot.column - spot.reach; c <= spot.column + spot.reach; ++c) {
      energy_.at<float>(r, c) += static_cast<float>(energy_j * spot.weight(r, c) / sum);
    }
  }
}

void Workpiece::ablate(const Vec2& at_m, double energy_j, double radius_m) {
  if (depth_.empty()) depth_ = zeros(settings_.pixels);
  const double radius = radius_m / pixel_m();
  const Spot spot{pixel_of(at_m), radius, static_cast<int>(std::ceil(1.6 * radius))};
  const double peak = 2.0 * energy_j / (std::numbers::pi * radius_m * radius_m);  // J/m^2 in the middle
  const int last = settings_.pixels - 1;
  for (int r = std::max(0, spot.row - spot.reach); r <= std::min(last, spot.row + spot.reach); ++r) {
    for (int c = std::max(0, spot.column - spot.reach); c <= std::min(last, spot.column + spot.reach); ++c) {
      float& depth = depth_.at<float>(r, c);
      const double deeper = depth + material_.depth_m(peak * spot.weight(r, c));
      depth = static_cast<float>(std::min(deeper, material_.thickness_m));
    }
  }
}

cv::Mat Workpiece::energy_j() const { return energy_.empty() ? zeros(settings_.pixels) : energy_; }
cv::Mat Workpiece::depth_m() const { return depth_.empty() ? zeros(settings_.pixels) : depth_; }

double Workpiece::depth_m(const Vec2& point_m) const noexcept {
  const cv::Point2d p = pixel_of(point_m);
  const int c = static_cast<int>(std::floor(p.x));
  const int r = static_cast<int>(std::floor(p.y));
  if (c < 0 || r < 0 || c + 1 >= depth_.cols || r + 1 >= depth_.rows) return 0.0;
  const double u = p.x - c;
  const double v = p.y - r;
  return (1 - v) * ((1 - u) * depth_.at<float>(r, c) + u * depth_.at<float>(r, c + 1)) +
         v * ((1 - u) * depth_.at<float>(r + 1, c) + u * depth_.at<float>(r + 1, c + 1));
}

}  // namespace telekerf::workpiece
