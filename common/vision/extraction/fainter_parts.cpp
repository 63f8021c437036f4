// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/fainter_parts.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "common/vision/extraction/tangents.h"
#include "common/vision/raster/edge_evidence.h"

namespace telekerf::vision {
namespace {

/// Share of some 200 places along an outline of which it is true; `there` gets the place and its normal.
template <typename There>
double share_along(const PixelContour& outline, const There& there) {
  constexpr std::size_t kPlaces = 200;
  const auto& points = outline.points_px;
  const std::vector<Vec2> tangents = tangents_of(points, true, 3);
  const std::size_t step = points.size() / kPlaces + 1;
  std::size_t so = 0;
  std::size_t all = 0;
  for (std::size_t i = 0; i < points.size(); i += step) {
    so += there(points[i], Vec2(-tangents[i].y(), tangents[i].x()));
    ++all;
  }
  return static_cast<double>(so) / static_cast<double>(std::max<std::size_t>(1, all));
}

/// Most of the outline is a step from background to drawing.
bool is_clear(const Field& field, double contrast, const PixelContour& outline) {
  constexpr double kStep = 0.4;   // of the faintest's contrast, from a pixel within to two beyond
  constexpr double kMost = 0.75;  // of the outline
  return share_along(outline, [&](const Vec2& at, const Vec2& left) {
           const auto from_to = [&](const Vec2& out) {
             return field.value(Vec2(at - out)) - field.value(Vec2(at + 2.0 * out));
           };
           return std::max(from_to(left), from_to(-left)) > kStep * contrast;
         }) > kMost;
}

/// What becomes of a shape of the fainter split.
struct FaintShape {
  int area = 0;
  int more = 0;  ///< of it, away from what is drawn anyway
  int drawn = 0;
  bool whole = false;
  bool taken = false;
};

void drop(Outlines& outlines, const std::vector<bool>& dropped) {
  Outlines kept;
  kept.cut_off = outlines.cut_off;
  for (std::size_t i = 0; i < dropped.size(); ++i) {
    if (dropped[i]) continue;
    kept.contours.push_back(std::move(outlines.contours[i]));
    kept.areas_px.push_back(outlines.areas_px[i]);
  }
  measure(kept);
  outlines = std::move(kept);
}

/// Share of an outline that lies along what is not `drawn`.
double beside(const PixelContour& outline, const cv::Mat& drawn) {
  constexpr double kOff_px = 5.0;
  return share_along(outline, [&](const Vec2& at, const Vec2& left) {
    for (const double side : {-kOff_px, kOff_px}) {
      const Vec2 p = at + side * left;
      const cv::Point there(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
      if (cv::Rect({}, drawn.size()).contains(there) && drawn.at<unsigned char>(there) == 0) return true;
    }
    return false;
  });
}

/// Across the outlines.
std::optional<double> median_step(const Field& field, const Outlines& outlines) {
  constexpr double kOff_px = 4.0;
  std::vector<double> steps;
  for (const PixelContour& outline : outlines.contours) {
    const std::vector<Vec2> tangents = tangents_of(outline.points_px, true, 3);
    for (std::size_t i = 0; i < tangents.size(); i += 8) {
      const Vec2 left(-tangents[i].y(), tangents[i].x());
      steps.push_back(std::abs(field.value(Vec2(outline.points_px[i] + kOff_px * left)) -
                               field.value(Vec2(outline.points_px[i] - kOff_px * left))));
    }
  }
  if (steps.empty()) return std::nullopt;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// Takes the darker parts of the `whole` shapes out of `outlines` and of what is drawn; what lies well
/// within one, with paler ground all round it, is drawn on it and stays.
void take_out_parts(const cv::Mat& whole, Field& field, Outlines& outlines) {
  constexpr double kAlong = 0.05;  // of the outline
  cv::Mat labels;
  const int count = cv::connectedComponents(field.drawn, labels, 8, CV_32S);
  std::vector<bool> part(static_cast<std::size_t>(count), false);
  std::vector<std::size_t> label_of;
  for (std::size_t i = 0; i < outlines.contours.size(); ++i) {
    const cv::Point seed = seed_of(outlines.contours[i]);
    label_of.push_back(static_cast<std::size_t>(labels.at<int>(seed)));
    if (outlines.areas_px[i] > 0.0 && whole.at<unsigned char>(seed) != 0)
      part[label_of.back()] = beside(outlines.contours[i], whole) > kAlong;
  }
  if (std::find(part.begin(), part.end(), true) == part.end()) return;
  field.drawn = field.drawn.clone();  // a copied field shares its planes
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      if (part[static_cast<std::size_t>(labels.at<int>(y, x))]) field.drawn.at<unsigned char>(y, x) = 0;
    }
  }
  std::vector<bool> dropped;
  for (const std::size_t label : label_of) dropped.push_back(part[label]);
  drop(outlines, dropped);
}

}  // namespace

std::optional<FainterParts> fainter_parts(Field& field, Outlines& outlines) {
  constexpr int kFewest_px = 24;     // pixels that are worth a look
  constexpr double kPaler = 0.08;    // of a shape: less is the blurred rim of a dark one
  constexpr std::size_t kMost = 60;  // shapes: more are texture
  FainterSplit split = at_fainter_level(field);
  FainterParts out{std::move(split.field), {}, field.drawn, 0.0};
  out.outlines = outlines_of(out.field);
  if (out.outlines.cut_off > outlines.cut_off) return std::nullopt;  // a shadow, and what its edge leaves
  cv::Mat near;
  const int rim = 2 * static_cast<int>(std::ceil(2.0 * field.sigma_px)) + 1;
  cv::dilate(field.drawn, near, cv::getStructuringElement(cv::MORPH_ELLIPSE, {rim, rim}));
  cv::Mat labels;
  const int count = cv::connectedComponents(out.field.drawn, labels, 8, CV_32S);
  std::vector<FaintShape> shapes(static_cast<std::size_t>(count));
  for (int y = 0; y < labels.rows; ++y) {
    const auto* label = labels.ptr<int>(y);
    const auto* drawn = field.drawn.ptr<unsigned char>(y);
    const auto* by = near.ptr<unsigned char>(y);
    for (int x = 0; x < labels.cols; ++x) {
      FaintShape& shape = shapes[static_cast<std::size_t>(label[x])];
      ++shape.area;
      shape.drawn += drawn[x] != 0;
      shape.more += by[x] == 0;
    }
  }
  std::vector<int> label_of;
  for (std::size_t i = 0; i < out.outlines.contours.size(); ++i) {
    label_of.push_back(labels.at<int>(seed_of(out.outlines.contours[i])));
    if (out.outlines.areas_px[i] <= 0.0) continue;
    FaintShape& shape = shapes[static_cast<std::size_t>(label_of.back())];
    shape.taken = shape.more >= kFewest_px && shape.more > kPaler * shape.area &&
                  is_clear(out.field, split.faintest, out.outlines.contours[i]);
  }
  shapes[0] = {};
  const auto taken = static_cast<std::size_t>(
      std::count_if(shapes.begin(), shapes.end(), [](const FaintShape& s) { return s.taken; }));
  if (taken == 0 || taken > kMost) return std::nullopt;
  std::vector<bool> dropped(out.outlines.contours.size());
  for (std::size_t i = 0; i < dropped.size(); ++i)
    dropped[i] = !shapes[static_cast<std::size_t>(label_of[i])].taken;
  drop(out.outlines, dropped);
  for (int y = 0; y < labels.rows; ++y) {
    const auto* label = labels.ptr<int>(y);
    for (int x = 0; x < labels.cols; ++x) {
      if (!shapes[static_cast<std::size_t>(label[x])].taken) out.field.drawn.at<unsigned char>(y, x) = 0;
    }
  }
  take_out_parts(out.field.drawn, field, outlines);
  out.step = median_step(field, outlines).value_or(field.contrast);
  return out;
}

}  // namespace telekerf::vision
