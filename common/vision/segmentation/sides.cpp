// SPDX-License-Identifier: Apache-2.0
#include "common/vision/segmentation/sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace telekerf::vision {
namespace {

/// Colours of one side of a stretch of an outline.
class Side {
 public:
  void add(const cv::Vec3f& colour) {
    sum_ += cv::Vec3d(colour);
    squares_ += cv::Vec3d(colour).dot(cv::Vec3d(colour));
    ++count_;
  }
  int count() const { return count_; }
  cv::Vec3d mean() const { return sum_ * (1.0 / count_); }
  double variance() const { return squares_ / count_ - mean().dot(mean()); }

 private:
  cv::Vec3d sum_{};
  double squares_ = 0.0;
  int count_ = 0;
};

/// Distance of the two sides' means, in standard deviations of the colours within them.
std::optional<double> separation(const Side& inside, const Side& outside) {
  constexpr int kFew = 8;
  constexpr double kSeen = 4.0;  // variance, units of L*a*b* squared: a distance of 2 is just seen
  if (inside.count() < kFew || outside.count() < kFew) return std::nullopt;
  const double variance = 0.5 * (inside.variance() + outside.variance());
  return cv::norm(inside.mean() - outside.mean()) / std::sqrt(std::max(0.0, variance) + kSeen);
}

}  // namespace

double unseparated(const Scene& scene, const cv::Mat& mask, const std::vector<cv::Point>& outline) {
  constexpr std::ptrdiff_t kStretch = 6;  // pixels to either side along the outline
  constexpr std::ptrdiff_t kLag = 5;      // of the tangent
  constexpr double kOfSize = 0.12;        // how deep a side is, of the region's size
  constexpr int kRim = 3;                 // pixels along the picture's border
  const auto n = static_cast<std::ptrdiff_t>(outline.size());
  if (n < 2 * kStretch) return 0.0;
  const double deep = std::clamp(kOfSize * std::sqrt(cv::contourArea(outline)), 4.0, 9.0);
  const cv::Rect picture({}, mask.size());
  const cv::Rect inner(kRim + 1, kRim + 1, mask.cols - 2 * kRim - 2, mask.rows - 2 * kRim - 2);
  const auto point = [&](std::ptrdiff_t i) { return outline[static_cast<std::size_t>((i + n) % n)]; };
  int looked = 0;
  int alike = 0;
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    if (!inner.contains(point(i))) continue;
    std::array<Side, 2> sides;
    for (std::ptrdiff_t j = i - kStretch; j <= i + kStretch; j += 2) {
      const cv::Point along = point(j + kLag) - point(j - kLag);
      const Vec2 normal(-along.y, along.x);
      if (normal.norm() < 1.0) continue;
      const Vec2 step = normal.normalized();
      for (double off = 2.0; off <= deep; off += 1.0) {
        for (const double sign : {-1.0, 1.0}) {
          const cv::Point p(static_cast<int>(std::lround(point(j).x + sign * off * step.x())),
                            static_cast<int>(std::lround(point(j).y + sign * off * step.y())));
          if (!picture.contains(p)) continue;
          sides[mask.at<unsigned char>(p) != 0 ? 1 : 0].add(scene.lab.at<cv::Vec3f>(p));
        }
      }
    }
    const auto apart = separation(sides[1], sides[0]);
    if (!apart) continue;
    ++looked;
    alike += *apart < 1.0;
  }
  return looked > 0 ? static_cast<double>(alike) / looked : 0.0;
}

double likeness_to_ring(const Scene& scene, const cv::Mat& mask) {
  constexpr float kNear = 2.0F;      // pixels: there the two mix
  constexpr double kOfSize = 0.5;    // the ring's width
  constexpr float kAlongL = 5.0F;    // of a bin
  constexpr float kAlongAb = 10.0F;  // likewise
  constexpr int kLs = 20;
  constexpr int kAbs = 14;
  const auto wide = static_cast<float>(std::max(3.0, kOfSize * std::sqrt(cv::countNonZero(mask))));
  cv::Mat distance;
  cv::distanceTransform(mask == 0, distance, cv::DIST_L2, 5);
  std::vector<double> inside(static_cast<std::size_t>(kLs * kAbs * kAbs), 0.0);
  std::vector<double> ring(inside);
  double insides = 0.0;
  double rings = 0.0;
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      const bool held = mask.at<unsigned char>(y, x) != 0;
      const float off = distance.at<float>(y, x);
      if (!held && (off <= kNear || off > wide)) continue;
      const auto& c = scene.lab.at<cv::Vec3f>(y, x);
      const auto bin = [](float value, float size, int bins) {
        return std::clamp(static_cast<int>(std::floor(value / size)), 0, bins - 1);
      };
      const float middle = 0.5F * kAbs * kAlongAb;
      const auto k = static_cast<std::size_t>(
          (bin(c[0], kAlongL, kLs) * kAbs + bin(c[1] + middle, kAlongAb, kAbs)) * kAbs +
          bin(c[2] + middle, kAlongAb, kAbs));
      (held ? inside : ring)[k] += 1.0;
      (held ? insides : rings) += 1.0;
    }
  }
  if (insides == 0.0 || rings == 0.0) return 0.0;
  double out = 0.0;
  for (std::size_t k = 0; k < inside.size(); ++k) out += std::sqrt(inside[k] / insides * ring[k] / rings);
  return out;
}

}  // namespace telekerf::vision
