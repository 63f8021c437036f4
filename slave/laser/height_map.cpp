// SPDX-License-Identifier: Apache-2.0
#include "slave/laser/height_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace telekerf::slave {
namespace {

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
  const int pulses = source_.fire(power_w, dt_s);
  const double energy = source_.pulse_energy_j();
  const double radius = source_.spot_radius_m(defocus_m);
  for (int i = 0; i < pulses; ++i) {
    const Vec2 at = from_m + (i + 0.5) / pulses * (to_m - from_m);
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

cv::Mat HeightMap::picture(int pixels) const {
  const cv::Mat depth = shrunk(depth_, pixels);
  cv::Mat out(depth.size(), CV_8UC3);
  for (int r = 0; r < depth.rows; ++r) {
    for (int c = 0; c < depth.cols; ++c) {
      const double burnt = 1.0 - std::exp(-3.0 * depth.at<float>(r, c) / material_.char_depth_m);
      // Grain: a slow ripple, enough to tell wood from paper.
      const double grain = 8.0 * std::sin(0.045 * c + 1.4 * std::sin(0.006 * r + 0.002 * c));
      for (int k = 0; k < 3; ++k) {
        out.at<cv::Vec3b>(r, c)[k] = cv::saturate_cast<std::uint8_t>(
            (1.0 - burnt) * (material_.paper_bgr[k] + grain) + burnt * material_.burnt_bgr[k]);
      }
    }
  }
  return out;
}

cv::Mat HeightMap::depth_picture(int pixels) const {
  const cv::Mat depth = shrunk(depth_, pixels);
  double deepest = 0.0;
  cv::minMaxLoc(depth, nullptr, &deepest);
  cv::Mat grey, out;
  depth.convertTo(grey, CV_8U, deepest > 0.0 ? 255.0 / deepest : 0.0);
  cv::applyColorMap(grey, out, cv::COLORMAP_VIRIDIS);
  const int height = out.rows / 2;
  for (int i = 0; i < height; ++i) {
    cv::Mat one(1, 1, CV_8U, cv::Scalar(255 - 255 * i / height)), colour;
    cv::applyColorMap(one, colour, cv::COLORMAP_VIRIDIS);
    out(cv::Rect(12, 30 + i, 16, 1)).setTo(cv::Scalar(colour.at<cv::Vec3b>(0, 0)));
  }
  char text[32];
  std::snprintf(text, sizeof text, "%.3f mm", deepest * 1e3);
  cv::putText(out, text, {34, 42}, cv::FONT_HERSHEY_SIMPLEX, 0.5, {255, 255, 255}, 1, cv::LINE_AA);
  cv::putText(out, "0", {34, 30 + height}, cv::FONT_HERSHEY_SIMPLEX, 0.5, {255, 255, 255}, 1, cv::LINE_AA);
  return out;
}

}  // namespace telekerf::slave
