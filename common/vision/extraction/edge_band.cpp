// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/edge_band.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace telekerf::vision {

cv::Mat edge_band(const Field& field, double stroke_width_px, bool is_stroke, double level) {
  // Sobel's gain is 8; a border blurred by sigma s has the slope contrast / (2.5 s).
  const double strong = 8.0 * field.contrast / (2.5 * std::hypot(field.sigma_px, 1.0));
  cv::Mat edges;
  cv::Canny(field.smooth, edges, 0.3 * level * strong, 0.7 * level * strong, 3, true);
  int size = 3;
  if (is_stroke) size = 2 * (static_cast<int>(std::ceil(0.5 * stroke_width_px)) + 1) + 1;
  const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_ELLIPSE, {size, size});
  cv::Mat closed;
  cv::copyMakeBorder(edges, closed, size, size, size, size, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::dilate(closed, closed, kernel);
  cv::erode(closed, closed, kernel);
  closed = closed(cv::Rect(size, size, edges.cols, edges.rows)).clone();

  cv::Mat weights;
  if (is_stroke) {
    cv::bitwise_or(closed, field.drawn, closed);  // where strokes cross, their edges are too far apart
    field.smooth.convertTo(weights, CV_32F, (field.dark ? -1.0 : 1.0) / (0.5 * field.contrast),
                           (field.dark ? 1.0 : -1.0) * field.level / (0.5 * field.contrast));
    weights = cv::min(cv::max(weights, 0.0), 1.0);
  } else {
    cv::Mat gx;
    cv::Mat gy;
    cv::Sobel(field.smooth, gx, CV_32F, 1, 0);
    cv::Sobel(field.smooth, gy, CV_32F, 0, 1);
    cv::magnitude(gx, gy, weights);
    weights /= strong;
    cv::dilate(closed, closed, cv::Mat());  // the ridge's flanks, for a centroid finer than a pixel
  }
  cv::Mat band(weights.size(), CV_32F, cv::Scalar(0));
  weights.copyTo(band, closed);
  return band;
}

std::optional<cv::Point> first_in_evolving_square(const cv::Mat& band) {
  const int rings = (std::min(band.cols, band.rows) + 1) / 2;
  for (int k = 0; k < rings; ++k) {
    const int right = band.cols - 1 - k;
    const int bottom = band.rows - 1 - k;
    for (int x = k; x <= right; ++x) {
      for (const int y : {k, bottom}) {
        if (band.at<float>(y, x) > kFaintWeight) return cv::Point(x, y);
      }
    }
    for (int y = k; y <= bottom; ++y) {
      for (const int x : {k, right}) {
        if (band.at<float>(y, x) > kFaintWeight) return cv::Point(x, y);
      }
    }
  }
  return std::nullopt;
}

}  // namespace telekerf::vision
