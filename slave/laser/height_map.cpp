// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/height_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "slave/laser/mark_picture.h"

namespace telekerf::laser {
namespace {

/// Below the raster in pictures, for the bar that shows the scale.
constexpr int kScaleStrip_px = 60;

cv::Mat shrunk(const cv::Mat& in, int pixels) {
  if (std::max(in.cols, in.rows) <= pixels) return in.clone();
  const double scale = static_cast<double>(pixels) / std::max(in.cols, in.rows);
  cv::Mat out;
  cv::resize(in, out, {}, scale, scale, cv::INTER_AREA);
  return out;
}

}  // namespace

HeightMap::HeightMap(const HeightMapSettings& settings, const Material& material,
                     const PulsedSourceSettings& source)
    : settings_(settings), material_(material), source_(source) {
  const int side = std::clamp(static_cast<int>(2.0 * settings.half_width_m / settings.pixel_m), 16, 8000);
  settings_.pixel_m = 2.0 * settings.half_width_m / side;
  depth_ = cv::Mat::zeros(side, side, CV_32F);
}

cv::Point2d HeightMap::pixel_of(const Vec2& point_m) const noexcept {
  const Vec2 p = (point_m - settings_.centre_m) / settings_.pixel_m;
  const double middle = 0.5 * (depth_.cols - 1);
  return {middle + p.x(), middle - p.y()};
}

void HeightMap::pulse(const Vec2& at_m, double energy_j, double radius_m) {
  const cv::Point2d centre = pixel_of(at_m);
  const double radius = radius_m / settings_.pixel_m;
  const int reach = static_cast<int>(std::ceil(1.6 * radius));
  const int column = static_cast<int>(std::lround(centre.x));
  const int row = static_cast<int>(std::lround(centre.y));
  const double peak = 2.0 * energy_j / (std::numbers::pi * radius_m * radius_m);  // J/m^2 in the middle
  const double area = settings_.pixel_m * settings_.pixel_m;
  for (int r = std::max(0, row - reach); r <= std::min(depth_.rows - 1, row + reach); ++r) {
    for (int c = std::max(0, column - reach); c <= std::min(depth_.cols - 1, column + reach); ++c) {
      const double dx = c - centre.x;
      const double dy = r - centre.y;
      const double fluence = peak * std::exp(-2.0 * (dx * dx + dy * dy) / (radius * radius));
      float& depth = depth_.at<float>(r, c);
      const double before = depth;
      depth = static_cast<float>(std::min(before + material_.depth_m(fluence), material_.thickness_m));
      energy_.removed_m3 += (depth - before) * area;
    }
  }
}

void HeightMap::expose(const Vec2& from_m, const Vec2& to_m, double power_w, double dt_s, double defocus_m,
                       const geometry::NearestIndex* corridor, double corridor_m) {
  const PulsedSource::Pulses pulses = source_.fire(power_w, dt_s);
  const double energy = source_.pulse_energy_j();
  const double radius = source_.spot_radius_m(defocus_m);
  for (int i = 0; i < pulses.count; ++i) {
    const Vec2 at = from_m + (pulses.first + i * pulses.step) * (to_m - from_m);
    pulse(at, energy, radius);
    const Vec2 off = (at - settings_.centre_m).cwiseAbs();
    const bool outside = off.maxCoeff() > settings_.half_width_m ||
                         (corridor != nullptr && corridor->find(at).distance_m > corridor_m);
    (outside ? energy_.outside_j : energy_.inside_j) += energy;
    energy_.absorbed_j += material_.absorption * energy;
  }
}

double HeightMap::depth_at(const Vec2& point_m) const noexcept {
  const cv::Point2d p = pixel_of(point_m);
  const int c = static_cast<int>(std::floor(p.x));
  const int r = static_cast<int>(std::floor(p.y));
  if (c < 0 || r < 0 || c + 1 >= depth_.cols || r + 1 >= depth_.rows) return 0.0;
  const double u = p.x - c;
  const double v = p.y - r;
  return (1 - v) * ((1 - u) * depth_.at<float>(r, c) + u * depth_.at<float>(r, c + 1)) +
         v * ((1 - u) * depth_.at<float>(r + 1, c) + u * depth_.at<float>(r + 1, c + 1));
}

cv::Mat HeightMap::shown(int pixels) const {
  cv::Mat out;
  cv::copyMakeBorder(shrunk(depth_, pixels), out, 0, kScaleStrip_px, 0, 0, cv::BORDER_CONSTANT, 0.0);
  return out;
}

cv::Mat HeightMap::picture(int pixels) const {
  cv::Mat burnt;
  cv::exp(shown(pixels) * (-3.0 / material_.char_depth_m), burnt);
  burnt = 1.0 - burnt;
  cv::Mat out = mark_picture(burnt, material_);
  draw_scale_bar(out, shown_pixel_m(out), ink_of(material_));
  return out;
}

cv::Mat HeightMap::depth_picture(int pixels) const {
  const auto coloured = [](const cv::Mat& share) {
    cv::Mat grey, out;
    share.convertTo(grey, CV_8U, 255.0);
    cv::applyColorMap(grey, out, cv::COLORMAP_VIRIDIS);
    return out;
  };
  const cv::Mat depth = shown(pixels);
  double deepest = 0.0;
  cv::minMaxLoc(depth, nullptr, &deepest);
  cv::Mat map = coloured(depth * (deepest > 0.0 ? 1.0 / deepest : 0.0));
  draw_scale_bar(map, shown_pixel_m(map), cv::Scalar::all(255));

  // The colours' scale stands beside the picture.
  constexpr int kBeside_px = 130;
  const cv::Scalar ink = cv::Scalar::all(40);
  cv::Mat out;
  cv::copyMakeBorder(map, out, 0, 0, 0, kBeside_px, cv::BORDER_CONSTANT, cv::Scalar::all(255));
  cv::Mat scale(map.rows / 2, 1, CV_32F);
  for (int i = 0; i < scale.rows; ++i) {
    scale.at<float>(i) = 1.0F - static_cast<float>(i) / static_cast<float>(scale.rows - 1);
  }
  const cv::Rect bar(map.cols + 12, 30, 16, scale.rows);
  cv::resize(coloured(scale), out(bar), bar.size(), 0, 0, cv::INTER_NEAREST);
  const auto write = [&](double value_m, int row) {
    cv::putText(out, fmt::format("{:.3g} mm", value_m * 1e3), {bar.x + 22, row}, cv::FONT_HERSHEY_SIMPLEX,
                0.5, ink, 1, cv::LINE_AA);
  };
  write(deepest, bar.y + 12);
  write(0.0, bar.y + bar.height);
  return out;
}

}  // namespace telekerf::laser
