// SPDX-License-Identifier: Apache-2.0
#include "common/vision/segmentation/rating.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace telekerf::vision {
namespace {

double percentile(std::vector<double>& values, double fraction) {
  if (values.empty()) return 0.0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

cv::Vec3f lab_at(const cv::Mat& lab, const Vec2& p) {
  const int x = std::clamp(static_cast<int>(std::lround(p.x())), 0, lab.cols - 1);
  const int y = std::clamp(static_cast<int>(std::lround(p.y())), 0, lab.rows - 1);
  return lab.at<cv::Vec3f>(y, x);
}

}  // namespace

double Rating::score() const {
  const double step = 0.5 * std::min(median, 50.0) + std::min(weak, 40.0) - 0.5 * texture;
  return std::max(0.0, step) * std::pow(area, 0.2) * std::pow(std::max(0.02, round), 0.15) *
         std::max(0.0, 1.0 - 1.5 * std::max(0.0, touching - 0.04));
}

Rating rating_of(const Scene& scene, const std::vector<cv::Point>& outline) {
  constexpr double kHalf = 2.0;      // half of the step across the outline, pixels
  constexpr double kNothing = 2.5;   // a step that is hardly seen, units of L*a*b*
  constexpr double kParallel = 6.0;  // how far the parallels lie off it
  const cv::Mat& lab = scene.lab;
  const auto n = outline.size();
  Rating out;
  if (n < 8) return out;
  std::vector<double> across;
  std::vector<double> beside;
  std::size_t touching = 0;
  std::array<bool, 4> seen{};
  const std::size_t step = n / 600 + 1;
  std::size_t looked = 0;
  for (std::size_t i = 0; i < n; i += step) {
    const cv::Point& here = outline[i];
    ++looked;
    if (here.x <= 1 || here.y <= 1 || here.x >= lab.cols - 2 || here.y >= lab.rows - 2) {
      ++touching;
      seen[0] = seen[0] || here.x <= 1;
      seen[1] = seen[1] || here.y <= 1;
      seen[2] = seen[2] || here.x >= lab.cols - 2;
      seen[3] = seen[3] || here.y >= lab.rows - 2;
      continue;
    }
    const cv::Point along = outline[(i + 4) % n] - outline[(i + n - 4) % n];
    const Vec2 tangent(along.x, along.y);
    if (tangent.norm() < 1.0) continue;
    const Vec2 normal = Vec2(-tangent.y(), tangent.x()).normalized();
    const Vec2 p(here.x, here.y);
    const auto contrast = [&](double off) {
      return cv::norm(lab_at(lab, p + (off + kHalf) * normal) - lab_at(lab, p + (off - kHalf) * normal));
    };
    across.push_back(std::max(contrast(0.5), contrast(-0.5)));
    beside.push_back(contrast(kParallel));
    beside.push_back(contrast(-kParallel));
  }
  out.touching = static_cast<double>(touching) / static_cast<double>(looked);
  out.sides = static_cast<int>(std::count(seen.begin(), seen.end(), true));
  out.blind = static_cast<double>(
                  std::count_if(across.begin(), across.end(), [](double off) { return off < kNothing; })) /
              static_cast<double>(std::max<std::size_t>(1, across.size()));
  out.median = percentile(across, 0.5);
  out.weak = percentile(across, 0.25);
  out.texture = percentile(beside, 0.5);
  const double area = cv::contourArea(outline);
  const double length = cv::arcLength(outline, true);
  out.area = area / static_cast<double>(lab.total());
  out.round = length > 0.0 ? 4.0 * M_PI * area / (length * length) : 0.0;
  return out;
}

std::vector<std::vector<cv::Point>> outlines_of_mask(const cv::Mat& mask, double min_area_px) {
  std::vector<std::vector<cv::Point>> all;
  cv::findContours(mask, all, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  std::erase_if(all, [&](const auto& outline) { return cv::contourArea(outline) < min_area_px; });
  return all;
}

cv::Mat parts_holding(const cv::Mat& mask, const std::vector<cv::Point>& points) {
  cv::Mat out(mask.size(), CV_8U, cv::Scalar(0));
  const auto all = outlines_of_mask(mask, 4.0);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool holds = std::any_of(points.begin(), points.end(), [&](const cv::Point& p) {
      return cv::pointPolygonTest(all[i], cv::Point2f(static_cast<float>(p.x), static_cast<float>(p.y)),
                                  false) >= 0;
    });
    if (holds) cv::drawContours(out, all, static_cast<int>(i), cv::Scalar(255), cv::FILLED);
  }
  return out;
}

}  // namespace telekerf::vision
