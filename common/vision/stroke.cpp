// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/vision/strokes.h"

namespace telekerf::vision {
namespace {

double length_of(const PixelContour& c) { return geometry::length_m({c.points_px, c.closed}); }

/// Twice the area over the perimeter: exact for a long stroke, a third of the diameter or so for a region.
struct Ink {
  double area = 0.0;
  double perimeter = 0.0;
  geometry::Box box;
};

Ink ink_of(const Outlines& outlines) {
  Ink ink;
  double largest = 0.0;
  for (const PixelContour& c : outlines.contours) {
    const double area = -geometry::signed_area_m2({c.points_px, true});  // y runs downwards
    ink.area += area;
    ink.perimeter += length_of(c);
    if (area > 0.0) {
      const geometry::Box box = geometry::bounding_box(c.points_px);
      if (box.size().norm() > largest) {
        largest = box.size().norm();
        ink.box = box;
      }
    }
  }
  return ink;
}

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

/// Distance to the background, where it will be asked for: around junctions, as far as a crossing may reach.
cv::Mat half_width_at_junctions(const cv::Mat& drawn, const SkeletonGraph& graph, double width_px) {
  const int reach = static_cast<int>(std::ceil(7.0 * width_px)) + 4;
  const auto patch_area = 4.0 * reach * reach;
  cv::Mat out(drawn.size(), CV_32F, cv::Scalar(0));
  if (patch_area * static_cast<double>(graph.nodes.size()) > 0.5 * static_cast<double>(drawn.total())) {
    cv::distanceTransform(drawn, out, cv::DIST_L2, cv::DIST_MASK_3);
    return out;
  }
  for (const SkeletonGraph::Node& node : graph.nodes) {
    if (node.degree < 3) continue;
    const cv::Point middle = node.pixels.front();
    const cv::Rect patch = cv::Rect(middle.x - reach, middle.y - reach, 2 * reach, 2 * reach) &
                           cv::Rect(0, 0, drawn.cols, drawn.rows);
    cv::Mat distance;
    cv::distanceTransform(drawn(patch), distance, cv::DIST_L2, cv::DIST_MASK_3);
    distance.copyTo(out(patch));
  }
  return out;
}

/// A drawn line whose ends nearly meet was meant to be closed.
void close_small_gap(PixelContour& contour) {
  if (contour.closed || contour.points_px.size() < 8) return;
  const auto& p = contour.points_px;
  const double gap = (p.front() - p.back()).norm();
  if (gap > 1.5 * contour.width_px + 2.0 || length_of(contour) < 8.0 * contour.width_px + 20.0) return;
  const Vec2 out = (p.back() - p[p.size() - 5]).normalized();
  const Vec2 in = (p[4] - p.front()).normalized();
  contour.closed = out.dot(in) > 0.5;
}

}  // namespace

double stroke_width_of(const Outlines& outlines) {
  const Ink ink = ink_of(outlines);
  return ink.perimeter > 0.0 ? 2.0 * std::max(0.0, ink.area) / ink.perimeter : 0.0;
}

double drawing_size_of(const Outlines& outlines) { return ink_of(outlines).box.size().norm(); }

Contours strokes_of(const Field& field, const Outlines& outlines) {
  const double width = std::max(1.0, stroke_width_of(outlines));
  geometry::Box box;
  bool any = false;
  std::vector<std::pair<double, const PixelContour*>> shapes;
  double largest = 0.0;
  for (const PixelContour& c : outlines.contours) {
    const double area = -geometry::signed_area_m2({c.points_px, true});
    shapes.emplace_back(area, &c);
    largest = std::max(largest, area);
  }
  for (const auto& [area, contour] : shapes) {
    if (area <= 0.0 || area < 0.002 * largest) continue;
    const geometry::Box b = geometry::bounding_box(contour->points_px);
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
    for (const auto& [area, contour] : shapes) {
      if (area > 0.0 && area >= 0.002 * largest) fill(whole, *contour, roi.tl());
    }
    cv::bitwise_and(drawn, whole, drawn);
  }
  const double pinhole = 0.15 * width * width + 2.0;
  for (const auto& [area, contour] : shapes) {
    if (area <= 0.0 && -area <= pinhole) fill(drawn, *contour, roi.tl());
  }

  cv::Mat padded;
  cv::copyMakeBorder(drawn, padded, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::Mat skeleton = padded.clone();
  thin(skeleton);
  SkeletonGraph graph = graph_of(skeleton);
  const cv::Mat half_width = half_width_at_junctions(padded, graph, width);
  graph = pruned(std::move(graph), skeleton, half_width);

  Contours out;
  for (Route& route : routes_through(graph, half_width, width)) {
    for (Vec2& p : route.points_px) p += Vec2(roi.x - 1, roi.y - 1);
    PixelContour contour = centred(field, route, width);
    close_small_gap(contour);
    out.push_back(std::move(contour));
  }
  return out;
}

}  // namespace telekerf::vision
