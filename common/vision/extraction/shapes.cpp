// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/shapes.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

namespace telekerf::vision {
namespace {

constexpr double kBand = 0.125;       ///< a band of even width is a stroke up to this fraction of its size
constexpr double kEven = 1.35;        ///< the middle line lies equally far from both sides all along
constexpr double kUneven = 2.1;       ///< no pen draws like this
constexpr double kNearlyThin = 0.02;  ///< from here on a shape may have a body
constexpr double kFat = 0.2;          ///< a region for certain: its width over its size
constexpr double kOfPen = 1.8;        ///< and over that of the pen
constexpr double kSmall = 0.05;       ///< of the largest shape: below, nothing is told apart

struct Shape {
  double area = 0.0;
  double perimeter = 0.0;
  double size = 0.0;
  int holes = 0;
  int label = 0;
  cv::Rect box;
  bool stroke = false;
  bool bulky = false;  ///< thin on average, but with a body

  double width() const { return perimeter > 0.0 ? 2.0 * std::max(0.0, area) / perimeter : 0.0; }
};

double perimeter_of(const PixelContour& c) { return length_px(c); }

/// How much the distance of the middle line from the rim varies along a shape: its largest values over its
/// smallest, 1 for a pen's line. Nothing if there is too little of it.
std::optional<double> variation_of(const Field& field, const cv::Mat& drawn) {
  cv::Mat own;
  cv::copyMakeBorder(drawn, own, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::Mat distance;
  cv::distanceTransform(own, distance, cv::DIST_L2, 5);
  std::vector<float> ridge;
  for (int y = 1; y + 1 < distance.rows; ++y) {
    for (int x = 1; x + 1 < distance.cols; ++x) {
      const float here = distance.at<float>(y, x);
      if (here < 2.0F * static_cast<float>(field.sigma_px)) continue;
      const bool along_x = here >= distance.at<float>(y, x - 1) && here >= distance.at<float>(y, x + 1);
      const bool along_y = here >= distance.at<float>(y - 1, x) && here >= distance.at<float>(y + 1, x);
      if (along_x && along_y) ridge.push_back(here);
    }
  }
  if (ridge.size() < 16) return std::nullopt;
  std::sort(ridge.begin(), ridge.end());
  const auto at = [&](double f) {
    return ridge[static_cast<std::size_t>(f * static_cast<double>(ridge.size() - 1))];
  };
  return at(0.9) / at(0.15);
}

bool is_even(const Field& field, const Shape& shape, const cv::Mat& labels) {
  return variation_of(field, labels(shape.box) == shape.label).value_or(9.0) < kEven;
}

/// All of one pen, straight or nearly, much longer than wide: a dashed line. Letters are not.
bool are_dashes(const std::vector<Shape>& shapes, const cv::Size& picture) {
  constexpr int kFewest = 4;
  constexpr double kWidest = 0.015;  // of the picture's diagonal
  constexpr double kSame = 0.12;     // of the mean width
  double sum = 0.0;
  double squares = 0.0;
  int count = 0;
  for (const Shape& s : shapes) {
    if (s.size <= 0.0) continue;
    const double length = 0.5 * s.perimeter - s.width();
    if (s.holes > 0 || s.size < 3.0 * s.width() || s.size < 0.85 * length) return false;
    sum += s.width();
    squares += s.width() * s.width();
    ++count;
  }
  if (count < kFewest) return false;
  const double mean = sum / count;
  return mean < kWidest * std::hypot(picture.width, picture.height) &&
         squares / count - mean * mean < kSame * kSame * mean * mean;
}

}  // namespace

ShapeKinds kinds_of(const Field& field, const Outlines& outlines) {
  ShapeKinds out;
  const bool all_strokes = outlines.thin();
  if (const auto outers = std::count_if(outlines.areas_px.begin(), outlines.areas_px.end(),
                                        [](double area) { return area > 0.0; });
      outers <= 1) {  // most pictures: one shape of a clear kind
    const double ratio = outlines.width_px / std::max(1.0, outlines.size_px);
    const bool holes = outlines.contours.size() > 1;
    if (all_strokes && (ratio < kNearlyThin || !holes)) return {outlines, {}, {}};
    if (!all_strokes && (ratio > kBand || !holes)) return {{}, outlines, {}};
  }
  cv::Mat labels;
  const int count = cv::connectedComponents(field.drawn, labels, 8, CV_32S);
  std::vector<Shape> shapes(static_cast<std::size_t>(count));
  std::vector<int> label_of;
  double largest = 0.0;
  for (std::size_t i = 0; i < outlines.contours.size(); ++i) {
    const PixelContour& c = outlines.contours[i];
    const int label = labels.at<int>(seed_of(c));
    label_of.push_back(label);
    Shape& shape = shapes[static_cast<std::size_t>(label)];
    shape.label = label;
    shape.area += outlines.areas_px[i];
    shape.perimeter += perimeter_of(c);
    if (outlines.areas_px[i] <= 0.0) {
      shape.holes += -outlines.areas_px[i] > 0.02 * std::abs(shape.area);
      continue;
    }
    const geometry::Box box = geometry::bounding_box(c.points_px);
    shape.size = box.size().norm();
    shape.box = cv::Rect(cv::Point(static_cast<int>(box.min.x()), static_cast<int>(box.min.y())),
                         cv::Point(static_cast<int>(box.max.x()) + 2, static_cast<int>(box.max.y()) + 2)) &
                cv::Rect({}, field.drawn.size());
    largest = std::max(largest, shape.size);
  }
  if (!all_strokes && are_dashes(shapes, field.drawn.size())) return {outlines, {}, {}};
  // The pen: of all that is clearly drawn with one, by length.
  double pen = 0.0;
  double drawn_length = 0.0;
  bool bands = false;  // the largest shape is one
  for (Shape& shape : shapes) {
    if (shape.size <= 0.0) continue;
    const double ratio = shape.width() / shape.size;
    shape.stroke = ratio < Outlines::kThin;
    if (shape.stroke && ratio > kNearlyThin && shape.size > kSmall * largest) {
      shape.bulky = variation_of(field, labels(shape.box) == shape.label).value_or(1.0) > kUneven;
      shape.stroke = !shape.bulky;
    }
    if (!shape.stroke && !shape.bulky && ratio < kBand && shape.holes > 0 && shape.size > kSmall * largest) {
      shape.stroke = is_even(field, shape, labels);
      bands = bands || (shape.stroke && shape.size == largest);
    }
    if (!shape.stroke) continue;
    pen += shape.width() * shape.perimeter;
    drawn_length += shape.perimeter;
  }
  pen = drawn_length > 0.0 ? pen / drawn_length : 0.0;
  const bool clear = std::any_of(shapes.begin(), shapes.end(), [&](const Shape& s) {
    return s.size > kSmall * largest && !s.stroke && s.width() > kOfPen * pen;
  });
  if (!all_strokes && !clear) return bands ? ShapeKinds{outlines, {}, {}} : ShapeKinds{{}, outlines, {}};
  bool strokes = false;
  bool regions = false;
  for (Shape& shape : shapes) {
    if (shape.size <= 0.0) continue;
    const double ratio = shape.width() / shape.size;
    // What is neither for certain goes with the picture.
    if (all_strokes && !shape.stroke && !shape.bulky)
      shape.stroke = ratio < kFat || shape.width() < kOfPen * pen;
    if (!all_strokes && shape.stroke && shape.size < 0.25 * largest) shape.stroke = false;
    if (shape.size < kSmall * largest) shape.stroke = all_strokes;
    (shape.stroke ? strokes : regions) = true;
  }
  if (!regions) return {outlines, {}, {}};
  if (!strokes) return {{}, outlines, {}};
  out.stroke_ink = field.drawn.clone();
  for (int y = 0; y < labels.rows; ++y) {
    auto* row = out.stroke_ink.ptr<unsigned char>(y);
    for (int x = 0; x < labels.cols; ++x) {
      if (row[x] != 0 && !shapes[static_cast<std::size_t>(labels.at<int>(y, x))].stroke) row[x] = 0;
    }
  }
  for (std::size_t i = 0; i < outlines.contours.size(); ++i) {
    const bool stroke = shapes[static_cast<std::size_t>(label_of[i])].stroke;
    Outlines& part = stroke ? out.strokes : out.regions;
    part.contours.push_back(outlines.contours[i]);
    part.areas_px.push_back(outlines.areas_px[i]);
  }
  out.strokes.cut_off = std::max(1, outlines.cut_off);
  out.regions.cut_off = outlines.cut_off;
  measure(out.strokes);
  measure(out.regions);
  return out;
}

bool is_of_one_pen(const Field& field, const Outlines& outlines) {
  const auto largest = std::max_element(outlines.contours.begin(), outlines.contours.end(),
                                        [](const auto& a, const auto& b) { return size_px(a) < size_px(b); });
  if (largest == outlines.contours.end()) return false;
  cv::Mat labels;
  cv::connectedComponents(field.drawn, labels, 8, CV_32S);
  Shape shape;
  shape.label = labels.at<int>(seed_of(*largest));
  shape.box = cv::Rect({}, field.drawn.size());
  return is_even(field, shape, labels);
}

}  // namespace telekerf::vision
