// SPDX-License-Identifier: Apache-2.0
#include "common/vision/segmentation/scene.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace telekerf::vision {
namespace {

using Row = Eigen::Matrix<double, 6, 1>;
using Colours = Eigen::Matrix<double, 6, 3>;

Row row_at(const cv::Mat& picture, int x, int y) {
  const double u = (x + 0.5) / picture.cols - 0.5;
  const double v = (y + 0.5) / picture.rows - 0.5;
  return Row(1.0, u, v, u * u, u * v, v * v);
}

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Scene scene_of(const cv::Mat& bgr, int longest_px) {
  Scene out;
  out.reduction = std::max(1.0, static_cast<double>(std::max(bgr.cols, bgr.rows)) / longest_px);
  if (out.reduction > 1.0) {
    const cv::Size size(std::max(8, static_cast<int>(bgr.cols / out.reduction)),
                        std::max(8, static_cast<int>(bgr.rows / out.reduction)));
    cv::resize(bgr, out.bgr, size, 0, 0, cv::INTER_AREA);
  } else {
    out.bgr = bgr;
  }
  cv::Mat wide;
  out.bgr.convertTo(wide, CV_32F, 1.0 / 255.0);
  cv::GaussianBlur(wide, wide, {}, 1.0);
  cv::cvtColor(wide, out.lab, cv::COLOR_BGR2Lab);
  return out;
}

Backdrop backdrop_of(const Scene& scene) {
  constexpr int kPasses = 8;
  const cv::Mat& lab = scene.lab;
  const int rim = std::max(3, std::min(lab.cols, lab.rows) / 25);
  const auto on_rim = [&](int x, int y) {
    return x < rim || y < rim || x >= lab.cols - rim || y >= lab.rows - rim;
  };
  const auto colour = [&](int x, int y) {
    const auto& p = lab.at<cv::Vec3f>(y, x);
    return Eigen::Vector3d(p[0], p[1], p[2]);
  };
  Colours light = Colours::Zero();
  std::vector<double> off;
  double spread = 1e3;
  for (int pass = 0; pass < kPasses; ++pass) {
    // The border alone first, with weights that fall with the distance; then all that looks like it.
    Eigen::Matrix<double, 6, 6> normal = 1e-4 * Eigen::Matrix<double, 6, 6>::Identity();
    Colours right = Colours::Zero();
    for (int y = 0; y < lab.rows; y += 2) {
      for (int x = 0; x < lab.cols; x += 2) {
        const bool rim_here = on_rim(x, y);
        if (!rim_here && pass < kPasses - 3) continue;
        const Row row = row_at(lab, x, y);
        const Eigen::Vector3d c = colour(x, y);
        const double r = (c - light.transpose() * row).norm();
        if (!rim_here && r > 2.5 * spread + 1.0) continue;
        const double w = pass == 0 ? 1.0 : 1.0 / (1.0 + std::pow(r / (2.0 * spread + 0.5), 2.0));
        normal += w * row * row.transpose();
        right += w * row * c.transpose();
      }
    }
    light = normal.ldlt().solve(right);
    off.clear();
    for (int y = 0; y < lab.rows; y += 2) {
      for (int x = 0; x < lab.cols; x += 2) {
        if (on_rim(x, y)) off.push_back((colour(x, y) - light.transpose() * row_at(lab, x, y)).norm());
      }
    }
    spread = median_of(off);
  }
  Backdrop out;
  out.spread = spread;
  out.tolerance = 3.0 * spread + 4.0;
  out.uniform = static_cast<double>(
                    std::count_if(off.begin(), off.end(), [&](double r) { return r < out.tolerance; })) /
                static_cast<double>(std::max<std::size_t>(1, off.size()));
  out.distance = cv::Mat(lab.size(), CV_32F);
  for (int y = 0; y < lab.rows; ++y) {
    for (int x = 0; x < lab.cols; ++x) {
      out.distance.at<float>(y, x) =
          static_cast<float>((colour(x, y) - light.transpose() * row_at(lab, x, y)).norm());
    }
  }
  return out;
}

}  // namespace telekerf::vision
