// SPDX-License-Identifier: Apache-2.0
#include "common/vision/raster/light.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace telekerf::vision {
namespace {

constexpr int kBlocks = 20;  ///< along each side of the picture

/// Each block's median, from a few of its pixels: the paper's, even where a good part of the block is drawn
/// on.
cv::Mat block_medians(const cv::Mat& grey) {
  constexpr int kSide = 5;
  cv::Mat out(kBlocks, kBlocks, CV_8U);
  std::array<unsigned char, std::size_t{kSide} * kSide> sample{};
  for (int y = 0; y < kBlocks; ++y) {
    for (int x = 0; x < kBlocks; ++x) {
      for (int k = 0; k < kSide * kSide; ++k) {
        const int row = (y * kSide + k / kSide) * (grey.rows - 1) / (kBlocks * kSide - 1);
        const int column = (x * kSide + k % kSide) * (grey.cols - 1) / (kBlocks * kSide - 1);
        sample[k] = grey.at<unsigned char>(row, column);
      }
      std::nth_element(sample.begin(), sample.begin() + sample.size() / 2, sample.end());
      out.at<unsigned char>(y, x) = sample[sample.size() / 2];
    }
  }
  return out;
}

}  // namespace

std::optional<Light> light_of(const cv::Mat& grey, double noise) {
  const cv::Mat medians = block_medians(grey);
  std::vector<unsigned char> values(medians.begin<unsigned char>(), medians.end<unsigned char>());
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  Light light = Light::Zero();
  light[0] = values[values.size() / 2];
  double tolerance = 40.0;
  double inside = 0.0;
  for (int pass = 0; pass < 8; ++pass) {
    Eigen::Matrix<double, 6, 6> normal = 1e-6 * Eigen::Matrix<double, 6, 6>::Identity();
    Light right = Light::Zero();
    inside = 0.0;
    for (int y = 0; y < kBlocks; ++y) {
      for (int x = 0; x < kBlocks; ++x) {
        const double u = (x + 0.5) / kBlocks - 0.5;
        const double v = (y + 0.5) / kBlocks - 0.5;
        const Light row(1.0, u, v, u * u, u * v, v * v);
        const double value = medians.at<unsigned char>(y, x);
        if (std::abs(value - row.dot(light)) > tolerance) continue;
        normal += row * row.transpose();
        right += value * row;
        inside += 1.0 / (kBlocks * kBlocks);
      }
    }
    if (inside < 0.5) return std::nullopt;
    light = normal.ldlt().solve(right);
    tolerance = std::max(0.7 * tolerance, 3.0 + noise);
  }
  return inside > 0.55 ? std::optional(light) : std::nullopt;
}

double change_of(const Light& light) {
  return 0.5 * light.segment<2>(1).lpNorm<1>() + 0.25 * light.tail<3>().lpNorm<1>();
}

cv::Mat flattened(const cv::Mat& picture, const Light& light) {
  constexpr int kStretch = 32;
  cv::Mat out(picture.size(), CV_8U);
  for (int y = 0; y < picture.rows; ++y) {
    const double v = (y + 0.5) / picture.rows - 0.5;
    const auto* in = picture.ptr<unsigned char>(y);
    auto* to = out.ptr<unsigned char>(y);
    for (int first = 0; first < picture.cols; first += kStretch) {
      const int end = std::min(first + kStretch, picture.cols);
      const double u = 0.5 * (first + end) / picture.cols - 0.5;
      const double change = (light[1] + light[3] * u + light[4] * v) * u + (light[2] + light[5] * v) * v;
      const auto more = static_cast<unsigned char>(std::clamp(std::lround(change), 0L, 255L));
      const auto less = static_cast<unsigned char>(std::clamp(std::lround(-change), 0L, 255L));
      const auto ceiling = static_cast<unsigned char>(255 - less);
      for (int x = first; x < end; ++x) {
        const unsigned char value = std::min(std::max(in[x], more), ceiling);
        to[x] = static_cast<unsigned char>(value - more + less);
      }
    }
  }
  return out;
}

}  // namespace telekerf::vision
