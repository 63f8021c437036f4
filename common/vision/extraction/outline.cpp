// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace telekerf::vision {
namespace {

// East, south, west, north: y downwards, so this order is clockwise as seen.
constexpr std::array<int, 4> kStepX{1, 0, -1, 0};
constexpr std::array<int, 4> kStepY{0, 1, 0, -1};
constexpr unsigned char kVisited = 127;  ///< the pixel's western side has been walked along

/// Walks the sides between drawn and empty pixels with the drawing on the left. Pixels that touch by a corner
/// belong together.
class BorderWalk {
 public:
  explicit BorderWalk(const Field& field) : field_(field), drawn_(field.drawn.clone()) {}

  Outlines all() {
    Outlines out;
    std::vector<cv::Point> seeds;
    std::vector<cv::Point> cut;
    for (int y = 0; y < drawn_.rows; ++y) {
      unsigned char before = 0;
      auto* row = drawn_.ptr<unsigned char>(y);
      for (int x = 0; x < drawn_.cols; ++x) {
        // Long runs of background or drawing are passed eight pixels at a time.
        std::uint64_t eight = 0;
        while (x + 8 <= drawn_.cols && (before == 0 || before == 255)) {
          std::memcpy(&eight, row + x, 8);
          if (eight != (before == 0 ? 0 : ~std::uint64_t{0})) break;
          x += 8;
        }
        if (x >= drawn_.cols) break;
        const unsigned char here = row[x];
        if (here == 255 && before == 0) {
          PixelContour contour;
          if (walk(x, y, contour.points_px)) {
            out.contours.push_back(std::move(contour));
            seeds.emplace_back(x, y);
          } else {
            ++out.cut_off;
            cut.emplace_back(x, y);
          }
        }
        before = row[x];
      }
    }
    if (!cut.empty()) drop_parts_of(cut, seeds, out.contours);
    return out;
  }

 private:
  /// Holes in ink that runs over the border are not whole either.
  void drop_parts_of(const std::vector<cv::Point>& cut, const std::vector<cv::Point>& seeds,
                     Contours& contours) const {
    cv::Mat labels;
    const int count = cv::connectedComponents(field_.drawn, labels, 8, CV_32S);
    std::vector<bool> is_cut(static_cast<std::size_t>(count), false);
    for (const cv::Point& p : cut) is_cut[labels.at<int>(p)] = true;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < contours.size(); ++i) {
      if (is_cut[labels.at<int>(seeds[i])]) continue;
      if (kept != i) contours[kept] = std::move(contours[i]);
      ++kept;
    }
    contours.resize(kept);
  }

  bool drawn(int x, int y) const noexcept {
    return x >= 0 && y >= 0 && x < drawn_.cols && y < drawn_.rows && drawn_.at<unsigned char>(y, x) != 0;
  }

  /// False when the walk came along the picture's border.
  bool walk(int x0, int y0, std::vector<Vec2>& points) {
    int x = x0;
    int y = y0;
    int side = 2;  // where the empty pixel is
    bool whole = true;
    do {
      if (side == 2) drawn_.at<unsigned char>(y, x) = kVisited;
      const int ex = x + kStepX[side];
      const int ey = y + kStepY[side];
      if (ex < 0 || ey < 0 || ex >= drawn_.cols || ey >= drawn_.rows) {
        whole = false;
      } else {
        const double inside = field_.value(x, y);
        const double outside = field_.value(ex, ey);
        const double t = inside / (inside - outside);
        points.emplace_back(x + t * kStepX[side], y + t * kStepY[side]);
      }
      const int ahead = (side + 3) % 4;
      const int ax = x + kStepX[ahead];
      const int ay = y + kStepY[ahead];
      if (drawn(ax + kStepX[side], ay + kStepY[side])) {  // round an inner corner
        x = ax + kStepX[side];
        y = ay + kStepY[side];
        side = (side + 1) % 4;
      } else if (drawn(ax, ay)) {
        x = ax;
        y = ay;
      } else {  // round an outer corner of the same pixel
        side = ahead;
      }
    } while (x != x0 || y != y0 || side != 2);
    return whole;
  }

  const Field& field_;
  cv::Mat drawn_;
};

}  // namespace

Outlines outlines_of(const Field& field) {
  Outlines out = BorderWalk(field).all();
  double area = 0.0;
  double perimeter = 0.0;
  for (const PixelContour& c : out.contours) {
    double twice = 0.0;
    Vec2 before = c.points_px.back();
    for (const Vec2& p : c.points_px) {
      twice -= geometry::cross(before - c.points_px[0], p - c.points_px[0]);  // y runs downwards
      perimeter += (p - before).norm();
      before = p;
    }
    out.areas_px.push_back(0.5 * twice);
    area += 0.5 * twice;
    if (twice > 0.0) out.size_px = std::max(out.size_px, geometry::bounding_box(c.points_px).size().norm());
  }
  out.width_px = perimeter > 0.0 ? 2.0 * std::max(0.0, area) / perimeter : 0.0;
  return out;
}

void measure(Outlines& part) {
  part.size_px = 0.0;
  double area = 0.0;
  double perimeter = 0.0;
  for (std::size_t i = 0; i < part.contours.size(); ++i) {
    area += part.areas_px[i];
    perimeter += length_px(part.contours[i]);
    if (part.areas_px[i] > 0.0) part.size_px = std::max(part.size_px, size_px(part.contours[i]));
  }
  part.width_px = perimeter > 0.0 ? 2.0 * std::max(0.0, area) / perimeter : 0.0;
}

cv::Point seed_of(const PixelContour& contour) {
  const Vec2& p = contour.points_px.front();
  return {static_cast<int>(std::floor(p.x())) + 1, static_cast<int>(std::lround(p.y()))};
}

}  // namespace telekerf::vision
