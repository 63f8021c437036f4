// SPDX-License-Identifier: Apache-2.0
#include "common/vision/raster/sheet.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/vision/raster/levels.h"

namespace telekerf::vision {
namespace {

constexpr int kLongest_px = 480;  ///< of the small picture that the sheet is looked for in

using Row = Eigen::Matrix<double, 6, 1>;

Row row_at(const cv::Mat& picture, int x, int y) {
  const double u = (x + 0.5) / picture.cols - 0.5;
  const double v = (y + 0.5) / picture.rows - 0.5;
  return Row(1.0, u, v, u * u, u * v, v * v);
}

/// The line through the steepest places across one side of the sheet: point and direction.
std::optional<cv::Vec4f> side_line(const cv::Mat& grey, const Vec2& a, const Vec2& b, double reach_px) {
  const Vec2 along = (b - a).normalized();
  const Vec2 out(along.y(), -along.x());  // corners run clockwise
  std::vector<cv::Point2f> places;
  constexpr int kPlaces = 120;
  for (int i = 4; i < kPlaces - 4; ++i) {
    const Vec2 p = a + (b - a) * (i / double(kPlaces));
    double steepest = 8.0;
    std::optional<Vec2> edge;
    const auto value = [&](double off) {
      const Vec2 q = p + off * out;
      const int x = std::clamp(static_cast<int>(std::lround(q.x())), 0, grey.cols - 1);
      const int y = std::clamp(static_cast<int>(std::lround(q.y())), 0, grey.rows - 1);
      return static_cast<double>(grey.at<unsigned char>(y, x));
    };
    for (double off = -reach_px; off <= reach_px; off += 0.5) {
      const double step = value(off - 1.5) - value(off + 1.5);
      if (step > steepest) {
        steepest = step;
        edge = p + off * out;
      }
    }
    if (edge) places.emplace_back(static_cast<float>(edge->x()), static_cast<float>(edge->y()));
  }
  if (places.size() < 20) return std::nullopt;
  cv::Vec4f line;
  cv::fitLine(places, line, cv::DIST_HUBER, 0, 0.01, 0.01);
  return line;
}

std::optional<Vec2> crossing(const cv::Vec4f& a, const cv::Vec4f& b) {
  const double det = double(a[0]) * b[1] - double(a[1]) * b[0];
  if (std::abs(det) < 0.1) return std::nullopt;
  const double t = (double(b[2] - a[2]) * b[1] - double(b[3] - a[3]) * b[0]) / det;
  return Vec2(a[2] + t * a[0], a[3] + t * a[1]);
}

/// Four corners of the convex outline, where its four long sides meet; empty if one lies off the picture.
std::vector<Vec2> corners_of(const cv::Mat& grey, const std::vector<cv::Point>& hull, double reach_px) {
  std::vector<cv::Point> quad;
  const double length = cv::arcLength(hull, true);
  for (double share = 0.02; share < 0.09 && quad.size() != 4; share += 0.01)
    cv::approxPolyDP(hull, quad, share * length, true);
  if (quad.size() != 4) return {};
  const double covered = cv::contourArea(quad) / cv::contourArea(hull);
  if (covered < 0.9 || covered > 1.1) return {};
  for (const cv::Point& p : quad) {
    if (p.x <= 1 || p.y <= 1 || p.x >= grey.cols - 2 || p.y >= grey.rows - 2) return {};
  }
  std::vector<Vec2> rough;
  for (const cv::Point& p : quad) rough.emplace_back(p.x, p.y);
  if (cv::contourArea(quad, true) < 0.0) std::reverse(rough.begin(), rough.end());  // clockwise as seen
  const auto first = std::min_element(rough.begin(), rough.end(),
                                      [](const Vec2& a, const Vec2& b) { return a.sum() < b.sum(); });
  std::rotate(rough.begin(), first, rough.end());
  std::vector<Vec2> out(rough);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto before = side_line(grey, rough[(i + 3) % 4], rough[i], reach_px);
    const auto after = side_line(grey, rough[i], rough[(i + 1) % 4], reach_px);
    if (!before || !after) continue;
    if (const auto p = crossing(*before, *after); p && (*p - rough[i]).norm() < 4.0 * reach_px) out[i] = *p;
  }
  return out;
}

}  // namespace

std::optional<Sheet> sheet_in(const cv::Mat& grey) {
  constexpr double kMinArea = 0.12;  // of the picture
  constexpr double kMaxArea = 0.96;
  constexpr double kConvex = 0.93;
  constexpr double kAskew = 0.012;  // of a side
  constexpr std::size_t kMostSides = 6;
  constexpr double kOnBorder = 0.4;  // of the picture's border
  constexpr double kPaper = 0.6;     // of the sheet is paper
  const double scale = std::min(1.0, double(kLongest_px) / std::max(grey.cols, grey.rows));
  cv::Mat small;
  cv::resize(grey, small, {}, scale, scale, cv::INTER_AREA);
  cv::GaussianBlur(small, small, {}, 1.5);
  const Split split = otsu(histogram_of(small));
  if (split.high_mean - split.low_mean < 30.0) return std::nullopt;
  const cv::Mat light = small > split.level;
  cv::Mat filled;
  cv::morphologyEx(light, filled, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
  std::vector<std::vector<cv::Point>> all;
  cv::findContours(filled, all, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  const auto largest = std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return cv::contourArea(a) < cv::contourArea(b);
  });
  if (largest == all.end()) return std::nullopt;
  std::vector<cv::Point> hull;
  cv::convexHull(*largest, hull);
  const double area = cv::contourArea(hull);
  const double total = static_cast<double>(small.total());
  if (area < kMinArea * total || area > kMaxArea * total || cv::contourArea(*largest) < kConvex * area)
    return std::nullopt;
  // Straight sides: a rectangle seen askew, perhaps cut off by the picture's border.
  std::vector<cv::Point> sides;
  cv::approxPolyDP(hull, sides, 0.02 * cv::arcLength(hull, true), true);
  if (sides.size() > kMostSides || cv::contourArea(sides) < 0.95 * area) return std::nullopt;
  cv::Mat sheet(small.size(), CV_8U, cv::Scalar(0));
  cv::fillConvexPoly(sheet, hull, cv::Scalar(255));
  if (cv::countNonZero(light & sheet) < kPaper * cv::countNonZero(sheet)) return std::nullopt;
  // The desk shows along most of the picture's border.
  const int on_border = cv::countNonZero(sheet.row(0)) + cv::countNonZero(sheet.row(sheet.rows - 1)) +
                        cv::countNonZero(sheet.col(0)) + cv::countNonZero(sheet.col(sheet.cols - 1));
  if (on_border > kOnBorder * 2.0 * (sheet.rows + sheet.cols)) return std::nullopt;
  const cv::Mat rim = cv::getStructuringElement(cv::MORPH_ELLIPSE, {9, 9});
  cv::Mat around;
  cv::dilate(sheet, around, rim);
  Histogram desk{};
  Histogram paper{};
  for (int y = 0; y < small.rows; ++y) {
    for (int x = 0; x < small.cols; ++x) {
      if (around.at<unsigned char>(y, x) == 0) desk[small.at<unsigned char>(y, x)] += 1.0;
      if (sheet.at<unsigned char>(y, x) != 0) paper[small.at<unsigned char>(y, x)] += 1.0;
    }
  }
  Sheet out;
  out.desk_level = percentile(desk, 0, 255, 0.5);
  out.desk_range = percentile(desk, 0, 255, 0.9) - percentile(desk, 0, 255, 0.1);
  out.paper_level = percentile(paper, 0, 255, 0.5);
  if (percentile(desk, 0, 255, 0.9) > out.paper_level - 15.0) return std::nullopt;
  for (const cv::Point& p : hull) {
    out.outline.emplace_back(static_cast<int>((p.x + 0.5) / scale), static_cast<int>((p.y + 0.5) / scale));
  }
  out.corners = corners_of(grey, out.outline, 3.0 / scale);
  out.askew = out.corners.empty();
  for (std::size_t i = 0; i < out.corners.size(); ++i) {
    const Vec2 side = out.corners[(i + 1) % 4] - out.corners[i];
    out.askew = out.askew || side.cwiseAbs().minCoeff() > kAskew * side.norm();
  }
  return out;
}

cv::Mat without_desk(const cv::Mat& grey, const Sheet& sheet) {
  cv::Mat inside(grey.size(), CV_8U, cv::Scalar(0));
  cv::fillConvexPoly(inside, sheet.outline, cv::Scalar(255));
  const int rim = std::max(3, std::min(grey.cols, grey.rows) / 60);
  cv::copyMakeBorder(inside, inside, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::erode(inside, inside, cv::getStructuringElement(cv::MORPH_RECT, {2 * rim + 1, 2 * rim + 1}));
  inside = inside(cv::Rect(1, 1, grey.cols, grey.rows)).clone();
  // The paper's light: fitted again and again without the ink.
  const int step = std::max(1, std::min(grey.cols, grey.rows) / 150);
  Row light = Row::Zero();
  light[0] = sheet.paper_level;
  double tolerance = 50.0;
  for (int pass = 0; pass < 6; ++pass) {
    Eigen::Matrix<double, 6, 6> normal = 1e-3 * Eigen::Matrix<double, 6, 6>::Identity();
    Row right = Row::Zero();
    for (int y = 0; y < grey.rows; y += step) {
      for (int x = 0; x < grey.cols; x += step) {
        if (inside.at<unsigned char>(y, x) == 0) continue;
        const Row row = row_at(grey, x, y);
        const double value = grey.at<unsigned char>(y, x);
        if (std::abs(value - row.dot(light)) > tolerance) continue;
        normal += row * row.transpose();
        right += value * row;
      }
    }
    light = normal.ldlt().solve(right);
    tolerance = std::max(12.0, 0.7 * tolerance);
  }
  cv::Mat out = grey.clone();
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      if (inside.at<unsigned char>(y, x) != 0) continue;
      // Beyond the sheet the parabola is not to be trusted far.
      out.at<unsigned char>(y, x) = cv::saturate_cast<unsigned char>(
          std::clamp(row_at(grey, x, y).dot(light), sheet.paper_level - 25.0, sheet.paper_level + 25.0));
    }
  }
  return out;
}

cv::Mat rectified(const cv::Mat& picture, const std::vector<Vec2>& corners, int width_px, int height_px) {
  std::vector<cv::Point2f> from;
  for (const Vec2& c : corners) from.emplace_back(static_cast<float>(c.x()), static_cast<float>(c.y()));
  // The sheet's edges are the outer edges of the outermost pixels.
  const auto w = static_cast<float>(width_px) - 0.5F;
  const auto h = static_cast<float>(height_px) - 0.5F;
  const std::vector<cv::Point2f> to{{-0.5F, -0.5F}, {w, -0.5F}, {w, h}, {-0.5F, h}};
  cv::Mat out;
  cv::warpPerspective(picture, out, cv::getPerspectiveTransform(from, to), {width_px, height_px},
                      cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return out;
}

}  // namespace telekerf::vision
