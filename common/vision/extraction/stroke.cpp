// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/stroke.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/vision/extraction/centre_line.h"
#include "common/vision/extraction/routes.h"
#include "common/vision/extraction/skeleton.h"
#include "common/vision/extraction/thinning.h"

namespace telekerf::vision {
namespace {

constexpr double kWideStroke_px = 24.0;

/// Draws the inside of a contour and its rim.
void fill(cv::Mat& picture, const PixelContour& contour, const cv::Point& origin) {
  std::vector<cv::Point> polygon;
  polygon.reserve(contour.points_px.size());
  for (const Vec2& p : contour.points_px) {
    polygon.emplace_back(static_cast<int>(std::lround(p.x())) - origin.x,
                         static_cast<int>(std::lround(p.y())) - origin.y);
  }
  const std::vector<std::vector<cv::Point>> polygons{polygon};
  cv::fillPoly(picture, polygons, cv::Scalar(255));
}

/// A drawn line whose ends nearly meet was meant to be closed.
void close_small_gap(PixelContour& contour) {
  if (contour.closed || contour.points_px.size() < 8) return;
  const auto& p = contour.points_px;
  const double gap = (p.front() - p.back()).norm();
  if (gap > 1.5 * contour.width_px + 2.0 || length_px(contour) < 8.0 * contour.width_px + 20.0) return;
  const Vec2 out = (p.back() - p[p.size() - 5]).normalized();
  const Vec2 in = (p[4] - p.front()).normalized();
  contour.closed = out.dot(in) > 0.5;
}

}  // namespace

Contours strokes_of(const Field& field, const Outlines& outlines) {
  const double width = std::max(1.0, outlines.width_px);
  const auto& shapes = outlines.contours;
  const auto& areas = outlines.areas_px;
  geometry::Box box;
  bool any = false;
  const double largest = areas.empty() ? 0.0 : *std::max_element(areas.begin(), areas.end());
  const auto counts = [&](std::size_t i) { return areas[i] > 0.0 && areas[i] >= 0.002 * largest; };
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (!counts(i)) continue;
    const geometry::Box b = geometry::bounding_box(shapes[i].points_px);
    box = any ? geometry::Box{box.min.cwiseMin(b.min), box.max.cwiseMax(b.max)} : b;
    any = true;
  }
  if (!any) return {};
  const cv::Rect roi = cv::Rect(cv::Point(int(box.min.x()) - 2, int(box.min.y()) - 2),
                                cv::Point(int(box.max.x()) + 4, int(box.max.y()) + 4)) &
                       cv::Rect(0, 0, field.drawn.cols, field.drawn.rows);
  cv::Mat drawn = field.drawn(roi).clone();
  if (outlines.cut_off > 0) {
    // Whole shapes only: what runs over the border stays out. Holes are as the picture has them.
    cv::Mat whole(roi.size(), CV_8U, cv::Scalar(0));
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      if (counts(i)) fill(whole, shapes[i], roi.tl());
    }
    cv::bitwise_and(drawn, whole, drawn);
  }
  const double pinhole = 0.15 * width * width + 2.0;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (areas[i] <= 0.0 && -areas[i] <= pinhole) fill(drawn, shapes[i], roi.tl());
  }
  // Ink much wider than a pen is thinned in small: thinning costs width times area, and centring finds the
  // middle in the whole picture anyway.
  const double reduction = std::max(1.0, std::floor(width / kWideStroke_px));
  if (reduction > 1.0) {
    cv::resize(drawn, drawn, {}, 1.0 / reduction, 1.0 / reduction, cv::INTER_AREA);
    drawn = drawn > 127;
  }
  cv::Mat skeleton = thinned(drawn);
  const SkeletonGraph graph = pruned(graph_of(skeleton), skeleton, drawn);

  Contours out;
  const Vec2 first = Vec2(roi.x, roi.y) + Vec2::Constant(0.5 * (reduction - 1.0));
  for (Route& route : routes_through(graph, drawn, width / reduction)) {
    for (Vec2& p : route.points_px) p = reduction * p + first;
    PixelContour contour = centred(field, route, width);
    close_small_gap(contour);
    out.push_back(std::move(contour));
  }
  return out;
}

}  // namespace telekerf::vision
