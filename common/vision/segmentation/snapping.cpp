// SPDX-License-Identifier: Apache-2.0
#include "common/vision/segmentation/snapping.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "common/vision/extraction/tangents.h"

namespace telekerf::vision {
namespace {

constexpr double kStep_px = 0.5;  ///< between the places that are looked at across an outline

using Colour = Eigen::Vector3d;

/// Bilinear; beyond the picture its border goes on.
Colour colour_at(const cv::Mat& picture, const Vec2& p) {
  const double px = std::clamp(p.x(), 0.0, picture.cols - 1.001);
  const double py = std::clamp(p.y(), 0.0, picture.rows - 1.001);
  const int x = static_cast<int>(px);
  const int y = static_cast<int>(py);
  const double u = px - x;
  const double v = py - y;
  const auto at = [&](int row, int column) {
    const auto& c = picture.at<cv::Vec3b>(row, column);
    return Colour(c[0], c[1], c[2]);
  };
  return (1 - v) * ((1 - u) * at(y, x) + u * at(y, x + 1)) +
         v * ((1 - u) * at(y + 1, x) + u * at(y + 1, x + 1));
}

/// Moves a closed line, points about a pixel apart, onto the strongest edge within reach: the path of largest
/// sum of steps from inside to outside, neighbours no further apart than one place.
void snap(const cv::Mat& picture, double reach_px, std::vector<Vec2>& points) {
  const auto n = points.size();
  const auto half = static_cast<std::ptrdiff_t>(std::ceil(reach_px / kStep_px));
  const auto places = static_cast<std::size_t>(2 * half + 1);
  const std::vector<Vec2> tangents = tangents_of(points, true, 4);
  constexpr std::ptrdiff_t kSlope = 2;  // places on either side that a step is measured over
  std::vector<Colour> row(places + 2 * kSlope);
  std::vector<std::vector<Colour>> steps(n, std::vector<Colour>(places));
  std::vector<Colour> sides(n);
  std::vector<Vec2> normals(n);
  for (std::size_t i = 0; i < n; ++i) {
    normals[i] = Vec2(-tangents[i].y(), tangents[i].x());
    for (std::size_t k = 0; k < row.size(); ++k) {
      const double off = kStep_px * static_cast<double>(static_cast<std::ptrdiff_t>(k) - half - kSlope);
      row[k] = colour_at(picture, points[i] + off * normals[i]);
    }
    for (std::size_t k = 0; k < places; ++k) steps[i][k] = row[k + 2 * kSlope] - row[k];
    sides[i] = row.back() - row.front();
  }
  // What the two sides differ by here, over a stretch of the outline.
  const auto window = static_cast<std::ptrdiff_t>(std::min<std::size_t>(12, n / 4));
  std::vector<std::vector<double>> gain(n, std::vector<double>(places));
  for (std::size_t i = 0; i < n; ++i) {
    Colour difference = Colour::Zero();
    for (std::ptrdiff_t k = -window; k <= window; ++k) {
      difference += sides[(i + n + static_cast<std::size_t>(static_cast<std::ptrdiff_t>(n) + k)) % n];
    }
    const double size = difference.norm();
    if (size > 0.0) difference /= size;
    for (std::size_t k = 0; k < places; ++k) {
      const double off =
          std::abs(static_cast<double>(k) - static_cast<double>(half)) / static_cast<double>(half + 1);
      // Between equal edges the nearer one.
      gain[i][k] = std::max(0.0, steps[i][k].dot(difference)) * (1.0 - 0.35 * off * off);
    }
  }
  // Twice round: the second time the start's place is known.
  std::vector<std::vector<unsigned char>> from(2 * n, std::vector<unsigned char>(places));
  std::vector<double> best(places, 0.0);
  std::vector<double> next(places);
  for (std::size_t i = 0; i < 2 * n; ++i) {
    for (std::size_t k = 0; k < places; ++k) {
      std::size_t chosen = k;
      for (const std::size_t other : {k - 1, k + 1}) {
        if (other < places && best[other] - 1.0 > best[chosen] - (chosen == k ? 0.0 : 1.0)) chosen = other;
      }
      from[i][k] = static_cast<unsigned char>(chosen + 1 - k);
      next[k] = best[chosen] - (chosen == k ? 0.0 : 1.0) + gain[i % n][k];
    }
    std::swap(best, next);
  }
  auto k = static_cast<std::size_t>(std::max_element(best.begin(), best.end()) - best.begin());
  std::vector<Vec2> moved(points);
  for (std::size_t i = 2 * n; i-- > n / 2;) {
    if (i < n + n / 2) {
      const std::size_t j = i % n;
      double off = static_cast<double>(k) - static_cast<double>(half);
      if (k > 0 && k + 1 < places) {  // the top of the parabola through three places
        const double a = gain[j][k - 1];
        const double b = gain[j][k];
        const double c = gain[j][k + 1];
        const double bend = a - 2.0 * b + c;
        if (bend < -1e-9) off += std::clamp(0.5 * (a - c) / bend, -0.5, 0.5);
      }
      moved[j] = points[j] + kStep_px * off * normals[j];
    }
    k = k + from[i][k] - 1;
  }
  points = std::move(moved);
}

}  // namespace

Contours snapped_outlines(const Scene& scene, const cv::Mat& mask, const cv::Mat& bgr) {
  Contours out;
  const double reach_px = 1.5 * scene.reduction + 2.0;
  const Vec2 last(bgr.cols - 1.0, bgr.rows - 1.0);
  std::vector<std::vector<cv::Point>> outlines;
  std::vector<cv::Vec4i> ranks;
  cv::findContours(mask, outlines, ranks, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    const auto& outline = outlines[k];
    if (cv::contourArea(outline) < 12.0) continue;
    PixelContour contour;
    contour.hole = ranks[k][3] >= 0;
    contour.points_px.reserve(outline.size());
    // findContours runs anticlockwise as seen, along the middles of the region's outermost pixels.
    for (const cv::Point& p : outline) contour.points_px.push_back(scene.to_picture(Vec2(p.x, p.y)));
    contour.points_px = geometry::resampled({contour.points_px, true}, 1.0).points_m;
    if (contour.points_px.size() < 12) continue;
    smooth_and_resample(contour, 1.5 * scene.reduction);
    const std::vector<Vec2> before = contour.points_px;
    snap(bgr, reach_px, contour.points_px);
    const double rim = 1.5 * scene.reduction + 1.0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      Vec2& p = contour.points_px[i];
      const Vec2& b = before[i];
      if (b.x() < rim || b.y() < rim || b.x() > last.x() - rim || b.y() > last.y() - rim) p = b;
      p = p.cwiseMax(Vec2::Zero()).cwiseMin(last);
    }
    out.push_back(std::move(contour));
  }
  return out;
}

}  // namespace telekerf::vision
