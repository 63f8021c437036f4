// SPDX-License-Identifier: Apache-2.0
#include "tools/draw-pictures/rendering.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace telekerf::drawing {

cv::Mat render(const Drawing& drawing, const Appearance& appearance) {
  constexpr int kFine = 6;
  constexpr int kShift = 8;
  cv::Mat fine(appearance.height_px * kFine, appearance.width_px * kFine, CV_8U, cv::Scalar(0));
  std::vector<std::vector<cv::Point>> lines;
  for (const geometry::Polyline& line : drawing.lines_px) {
    lines.emplace_back();
    for (const Vec2& p : line.points_m) {
      // The centre of pixel i lies at fine coordinate (i + 1/2) * kFine - 1/2.
      const Vec2 f = (p.array() + 0.5) * kFine - 0.5;
      lines.back().emplace_back(static_cast<int>(std::lround(f.x() * (1 << kShift))),
                                static_cast<int>(std::lround(f.y() * (1 << kShift))));
    }
  }
  if (drawing.filled) {
    cv::fillPoly(fine, lines, cv::Scalar(255), cv::LINE_8, kShift);
  } else {
    const int thickness = std::max(1, static_cast<int>(std::lround(drawing.pen_px * kFine)));
    for (std::size_t i = 0; i < lines.size(); ++i) {
      cv::polylines(fine, lines[i], drawing.lines_px[i].closed, cv::Scalar(255), thickness, cv::LINE_8,
                    kShift);
    }
  }
  cv::Mat ink;
  cv::resize(fine, ink, {appearance.width_px, appearance.height_px}, 0, 0, cv::INTER_AREA);

  cv::Mat picture(ink.size(), CV_32F);
  for (int y = 0; y < ink.rows; ++y) {
    for (int x = 0; x < ink.cols; ++x) {
      const double ink_fraction = ink.at<unsigned char>(y, x) / 255.0;
      const double dim = appearance.shading * (double(x) / ink.cols + double(y) / ink.rows) * 0.5;
      picture.at<float>(y, x) =
          float(appearance.paper + ink_fraction * (appearance.ink - appearance.paper) - dim);
    }
  }
  cv::RNG rng(appearance.seed);
  if (appearance.grain > 0.0) {
    cv::Mat grain(ink.rows / 8 + 1, ink.cols / 8 + 1, CV_32F);
    rng.fill(grain, cv::RNG::NORMAL, 0.0, appearance.grain);
    cv::resize(grain, grain, ink.size(), 0, 0, cv::INTER_CUBIC);
    picture += grain;
  }
  if (appearance.blur_px > 0.0) cv::GaussianBlur(picture, picture, {}, appearance.blur_px);
  if (appearance.noise > 0.0) {
    cv::Mat noise(ink.size(), CV_32F);
    rng.fill(noise, cv::RNG::NORMAL, 0.0, appearance.noise);
    picture += noise;
  }
  cv::Mat out;
  picture.convertTo(out, CV_8U);
  return out;
}

}  // namespace telekerf::drawing
