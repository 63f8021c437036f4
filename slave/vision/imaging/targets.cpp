// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/targets.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace telekerf::imaging {
namespace {

constexpr double kPaper = 215.0;
constexpr double kInk = 40.0;
constexpr double kMiddle = 150.0;
constexpr int kPart = 4;  ///< bits of a coordinate below the pixel, for OpenCV's `shift`

cv::Point fixed(double x, double y) {
  return {static_cast<int>(std::lround(x * (1 << kPart))), static_cast<int>(std::lround(y * (1 << kPart)))};
}

/// Rings and ridges as a height, seen as its slope towards the light.
cv::Mat relief(int size, double structure_px, cv::RNG& random) {
  cv::Mat height(size, size, CV_32F, cv::Scalar(0));
  const int rings = std::max(40, size * size / 300);
  for (int i = 0; i < rings; ++i) {
    const double x = random.uniform(0.0, double(size));
    const double y = random.uniform(0.0, double(size));
    const double radius = random.uniform(3.0 * structure_px, 20.0 * structure_px);
    const double level = random.uniform(-1.0, 1.0);
    const int width = static_cast<int>(std::lround(random.uniform(1.0, 5.0) * structure_px));
    cv::circle(height, fixed(x, y), fixed(radius, 0).x, cv::Scalar(level), std::max(1, width), cv::LINE_AA,
               kPart);
  }
  cv::Mat slope;
  cv::GaussianBlur(height, height, {}, 1.2 * structure_px);
  cv::Sobel(height, slope, CV_32F, 1, 0);
  return kMiddle + 60.0 * structure_px * slope;
}

/// Octaves of smooth noise.
cv::Mat tissue(int size, double structure_px, cv::RNG& random) {
  cv::Mat out(size, size, CV_32F, cv::Scalar(kMiddle));
  for (int octave = 1; octave < 6; ++octave) {
    const int cells = std::max(2, static_cast<int>(size / (structure_px * (1 << octave))));
    cv::Mat coarse(cells, cells, CV_32F);
    random.fill(coarse, cv::RNG::UNIFORM, -1.0, 1.0);
    cv::Mat fine;
    cv::resize(coarse, fine, {size, size}, 0, 0, cv::INTER_CUBIC);
    out += 9.0 * std::pow(1.25, octave) * fine;
  }
  return out;
}

/// One letter after the other, as on a printed page seen from near.
cv::Mat letter(int size, double structure_px) {
  cv::Mat out(size, size, CV_32F, cv::Scalar(kPaper));
  const double cell = 110.0 * structure_px;
  const int across = std::max(1, static_cast<int>(std::ceil(size / cell)));
  for (int row = 0; row < across; ++row) {
    for (int column = 0; column < across; ++column) {
      const cv::Point corner(static_cast<int>((column + 0.08) * cell), static_cast<int>((row + 0.85) * cell));
      cv::putText(out, (row + column) % 2 == 0 ? "E" : "K", corner, cv::FONT_HERSHEY_TRIPLEX, cell / 28.0,
                  cv::Scalar(kInk), std::max(1, static_cast<int>(cell / 36.0)), cv::LINE_AA);
    }
  }
  return out;
}

cv::Mat grid(int size, double pitch_px) {
  cv::Mat out(size, size, CV_32F, cv::Scalar(kPaper));
  const double middle = 0.5 * (size - 1);
  const int half = static_cast<int>(middle / pitch_px);
  for (int row = -half; row <= half; ++row) {
    for (int column = -half; column <= half; ++column) {
      cv::circle(out, fixed(middle + column * pitch_px, middle + row * pitch_px),
                 fixed(0.5 * kDotShare * pitch_px, 0).x, cv::Scalar(kInk), cv::FILLED, cv::LINE_AA, kPart);
    }
  }
  return out;
}

}  // namespace

cv::Mat draw_target(Target target, int size, double structure_px, std::uint64_t seed) {
  cv::RNG random(seed + 1);
  cv::Mat out;
  switch (target) {
    case Target::kRelief:
      out = relief(size, structure_px, random);
      break;
    case Target::kTissue:
      out = tissue(size, structure_px, random);
      break;
    case Target::kLetter:
      out = letter(size, structure_px);
      break;
    case Target::kGrid:
      out = grid(size, structure_px);
      break;
    case Target::kBlank:
      out = cv::Mat(size, size, CV_32F, cv::Scalar(kMiddle));
      break;
  }
  return cv::min(cv::max(out, 0.0), 255.0);
}

}  // namespace telekerf::imaging
