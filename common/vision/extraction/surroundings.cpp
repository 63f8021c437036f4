// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/surroundings.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>
#include <utility>

#include "common/vision/raster/sheet.h"

namespace telekerf::vision {
namespace {

double median_inside(const cv::Mat& grey, const cv::Mat& mask) {
  std::vector<unsigned char> values;
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      if (mask.at<unsigned char>(y, x) != 0) values.push_back(grey.at<unsigned char>(y, x));
    }
  }
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Long thin dark lines, a little wider than they are; `width`: the widest that counts.
cv::Mat hair_in(const cv::Mat& grey, int width, double min_depth) {
  const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * width + 1, 2 * width + 1});
  cv::Mat smooth;
  cv::Mat depth;
  cv::GaussianBlur(grey, smooth, {}, 1.0);
  cv::morphologyEx(smooth, depth, cv::MORPH_BLACKHAT, kernel);
  cv::Mat lines = depth > min_depth;
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centres;
  const int count = cv::connectedComponentsWithStats(lines, labels, stats, centres, 8, CV_32S);
  std::vector<bool> keep(static_cast<std::size_t>(count), false);
  for (int i = 1; i < count; ++i) {
    const double reach =
        std::hypot(stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT));
    keep[static_cast<std::size_t>(i)] = reach > 6.0 * width;
  }
  for (int y = 0; y < lines.rows; ++y) {
    for (int x = 0; x < lines.cols; ++x) {
      if (!keep[static_cast<std::size_t>(labels.at<int>(y, x))]) lines.at<unsigned char>(y, x) = 0;
    }
  }
  cv::dilate(lines, lines, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
  return lines;
}

}  // namespace

std::optional<Cleared> on_sheet(const cv::Mat& grey, const tl::expected<Separation, std::string>& first) {
  constexpr double kExplained = 0.9;   // of the sharp edges on the sheet
  constexpr double kOtherLevel = 0.2;  // of the contrast
  // On a light ground there is no sheet to be found.
  if (first && first->field.dark) return std::nullopt;
  const auto sheet = sheet_in(grey);
  if (!sheet) return std::nullopt;
  auto found = separated(without_desk(grey, *sheet));
  if (!found || !found->field.dark || found->outlines.contours.empty() || found->edges.explained < kExplained)
    return std::nullopt;
  const double contrast = found->field.contrast;
  const bool even_ground = sheet->desk_range < 0.08 * contrast;
  const bool like_ink =
      std::abs(sheet->desk_level - median_inside(grey, found->field.drawn)) < kOtherLevel * contrast;
  if (even_ground && like_ink && !sheet->askew && !found->outlines.thin()) return std::nullopt;
  return Cleared{std::move(*found), "on a sheet, what lies round it is left out", {}};
}

std::optional<Cleared> under_hair(const cv::Mat& grey, const tl::expected<Separation, std::string>& first) {
  constexpr std::size_t kFewContours = 4;
  constexpr double kLongest_px = 900.0;
  constexpr std::size_t kClean = 6;  // contours that a cleared region may have
  // Hair that reaches the border cuts the region off; hair that does not makes a thin thing with many gaps of
  // it.
  const bool suspicious = !first || first->outlines.cut_off > 0 ||
                          (first->outlines.thin() && first->outlines.contours.size() >= kFewContours);
  if (!suspicious) return std::nullopt;
  const int width = std::max(5, std::min(grey.cols, grey.rows) / 75);
  const double depth = first ? std::max(10.0, 0.12 * first->field.contrast) : 14.0;
  // Looked for in small: a closing as wide as this costs much.
  const double reduction = std::max(1.0, std::max(grey.cols, grey.rows) / kLongest_px);
  cv::Mat hair;
  if (reduction > 1.0) {
    cv::resize(grey, hair, {}, 1.0 / reduction, 1.0 / reduction, cv::INTER_AREA);
    hair = hair_in(hair, std::max(4, static_cast<int>(width / reduction)), depth);
    cv::resize(hair, hair, grey.size(), 0, 0, cv::INTER_NEAREST);
  } else {
    hair = hair_in(grey, width, depth);
  }
  const int hairs = cv::countNonZero(hair);
  if (hairs < 12 * width || hairs > 0.3 * static_cast<double>(grey.total())) return std::nullopt;
  cv::Mat cleared;
  cv::inpaint(grey, hair, cleared, 4.0, cv::INPAINT_TELEA);
  auto found = separated(cleared);
  if (!found || !found->field.dark || found->outlines.thin() || !found->stands_out ||
      found->outlines.contours.size() > kClean)
    return std::nullopt;
  // Lines over the region as well as beside it; what is drawn beside a dot is no hair.
  cv::Mat inside;
  cv::Mat around;
  const cv::Mat rim = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * width + 1, 2 * width + 1});
  cv::copyMakeBorder(found->field.drawn, around, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::erode(around, inside, rim);
  cv::dilate(found->field.drawn, around, rim);
  inside = inside(cv::Rect(1, 1, grey.cols, grey.rows));
  const int over = cv::countNonZero(hair & inside);
  const int beside = cv::countNonZero(hair & ~around);
  if (over < 6 * width || beside < 6 * width) return std::nullopt;
  return Cleared{std::move(*found), "hair over it is left out", hair};
}

void lead_through(const cv::Mat& hidden, PixelContour& outline) {
  constexpr double kSide_px = 8.0;  // of the outline that says where it goes
  auto points = geometry::resampled({outline.points_px, true}, 1.0).points_m;
  const auto n = points.size();
  if (n < 64) return;
  const auto is_hidden = [&](const Vec2& p) {
    const int x = std::clamp(static_cast<int>(std::lround(p.x())), 0, hidden.cols - 1);
    const int y = std::clamp(static_cast<int>(std::lround(p.y())), 0, hidden.rows - 1);
    return hidden.at<unsigned char>(y, x) != 0;
  };
  // Begin where a clear stretch ends.
  std::size_t first = 0;
  while (first < n && !(!is_hidden(points[first]) && is_hidden(points[(first + 1) % n]))) ++first;
  if (first == n) return;
  std::rotate(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(first), points.end());
  std::vector<bool> clear(n);
  for (std::size_t i = 0; i < n; ++i) clear[i] = !is_hidden(points[i]);
  // A clear stretch between two hairs that is too short says nothing.
  for (std::size_t i = 0; i < n;) {
    std::size_t end = i;
    while (end < n && clear[end] == clear[i]) ++end;
    if (clear[i] && end - i < static_cast<std::size_t>(kSide_px) && i > 0)
      std::fill(clear.begin() + static_cast<std::ptrdiff_t>(i),
                clear.begin() + static_cast<std::ptrdiff_t>(end), false);
    i = end;
  }
  clear[0] = true;
  std::vector<Vec2> out;
  const auto side = static_cast<std::size_t>(kSide_px);
  for (std::size_t i = 0; i < n; ++i) {
    if (clear[i]) {
      out.push_back(points[i]);
      continue;
    }
    std::size_t end = i;
    while (end < n && !clear[end]) ++end;
    const Vec2 a = points[i - 1];
    const Vec2 b = points[end % n];
    const double gap = (b - a).norm();
    const Vec2 leaves = (a - points[(i - 1 + n - side) % n]).normalized() * gap;
    const Vec2 arrives = (points[(end + side) % n] - b).normalized() * gap;
    const auto steps = static_cast<std::size_t>(std::ceil(gap));
    for (std::size_t k = 1; k < steps; ++k) {  // Hermite's cubic
      const double t = static_cast<double>(k) / static_cast<double>(steps);
      const double u = 1.0 - t;
      out.push_back(u * u * (1.0 + 2.0 * t) * a + t * u * u * leaves + t * t * (3.0 - 2.0 * t) * b -
                    t * t * u * arrives);
    }
    i = end - 1;
  }
  outline.points_px = geometry::resampled({out, true}, 1.0).points_m;
}

}  // namespace telekerf::vision
