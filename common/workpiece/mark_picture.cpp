// SPDX-License-Identifier: Apache-2.0
#include "common/workpiece/mark_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace telekerf::workpiece {
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

/// The depths as pictures show them.
cv::Mat shown(const Workpiece& workpiece, int pixels) {
  cv::Mat out;
  cv::copyMakeBorder(shrunk(workpiece.depth_m(), pixels), out, 0, kScaleStrip_px, 0, 0, cv::BORDER_CONSTANT,
                     0.0);
  return out;
}

double shown_pixel_m(const Workpiece& workpiece, const cv::Mat& picture) {
  return workpiece.pixel_m() * workpiece.depth_m().cols / picture.cols;
}

/// CV_32F, 0..1, as colours.
cv::Mat coloured(const cv::Mat& fraction) {
  cv::Mat grey, out;
  fraction.convertTo(grey, CV_8U, 255.0);
  cv::applyColorMap(grey, out, cv::COLORMAP_VIRIDIS);
  return out;
}

/// The colours' scale beside the map.
cv::Mat with_colour_scale(const cv::Mat& map, double deepest_m) {
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
  write(deepest_m, bar.y + 12);
  write(0.0, bar.y + bar.height);
  return out;
}

}  // namespace

cv::Mat burnt_fraction(const cv::Mat& raster, double dark) {
  cv::Mat burnt;
  cv::exp(raster * (-3.0 / dark), burnt);
  burnt = 1.0 - burnt;
  return burnt;
}

cv::Mat mark_picture(const cv::Mat& burnt, const Material& material) {
  cv::Mat out(burnt.size(), CV_8UC3);
  for (int r = 0; r < out.rows; ++r) {
    for (int c = 0; c < out.cols; ++c) {
      const double fraction = burnt.at<float>(r, c);
      // Grain: a slow ripple, enough to tell wood from paper.
      const double grain = 8.0 * std::sin(0.045 * c + 1.4 * std::sin(0.006 * r + 0.002 * c));
      for (int k = 0; k < 3; ++k) {
        out.at<cv::Vec3b>(r, c)[k] = cv::saturate_cast<std::uint8_t>(
            (1.0 - fraction) * (material.paper_bgr[k] + grain) + fraction * material.burnt_bgr[k]);
      }
    }
  }
  return out;
}

void draw_scale_bar(cv::Mat& picture, double pixel_m, const cv::Scalar& colour_bgr) {
  const double most_mm = picture.cols * pixel_m * 1e3 / 4.0;
  const double decade = std::pow(10.0, std::floor(std::log10(most_mm)));
  const double length_mm = decade * (most_mm >= 5.0 * decade ? 5.0 : most_mm >= 2.0 * decade ? 2.0 : 1.0);
  const cv::Point from(40, picture.rows - 25);
  const cv::Point way(static_cast<int>(std::lround(length_mm * 1e-3 / pixel_m)), 0);
  cv::line(picture, from, from + way, colour_bgr, 3, cv::LINE_AA);
  cv::putText(picture, fmt::format("{:g} mm", length_mm), from + cv::Point(0, -12), cv::FONT_HERSHEY_SIMPLEX,
              0.7, colour_bgr, 2, cv::LINE_AA);
}

cv::Mat picture_of(const Workpiece& workpiece, int pixels) {
  const Material& material = workpiece.material();
  cv::Mat out = mark_picture(burnt_fraction(shown(workpiece, pixels), material.char_depth_m), material);
  draw_scale_bar(out, shown_pixel_m(workpiece, out), ink_of(material));
  return out;
}

cv::Mat depth_picture(const Workpiece& workpiece, int pixels) {
  const cv::Mat depth = shown(workpiece, pixels);
  double deepest_m = 0.0;
  cv::minMaxLoc(depth, nullptr, &deepest_m);
  cv::Mat map = coloured(depth * (deepest_m > 0.0 ? 1.0 / deepest_m : 0.0));
  draw_scale_bar(map, shown_pixel_m(workpiece, map), cv::Scalar::all(255));
  return with_colour_scale(map, deepest_m);
}

}  // namespace telekerf::workpiece
