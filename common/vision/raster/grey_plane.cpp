// SPDX-License-Identifier: Apache-2.0
#include "common/vision/raster/grey_plane.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "common/vision/raster/levels.h"

namespace telekerf::vision {
namespace {

constexpr int kMinSide_px = 8;

/// Values that all but a few pixels lie between: hot pixels must not take the contrast.
std::pair<double, double> range_of(const cv::Mat& wide) {
  std::vector<std::uint32_t> counts(65536, 0);
  const cv::Mat flat = wide.reshape(1);
  for (int y = 0; y < flat.rows; ++y) {
    const auto* row = flat.ptr<std::uint16_t>(y);
    for (int x = 0; x < flat.cols; ++x) ++counts[row[x]];
  }
  const double few = 2e-5 * static_cast<double>(flat.total());
  int low = 0;
  int high = 65535;
  for (double seen = counts[low]; seen <= few && low < high; seen += counts[++low]) {
  }
  for (double seen = counts[high]; seen <= few && high > low; seen += counts[--high]) {
  }
  return {low, high};
}

/// Any depth -> 8 bits; more than 8 bits are stretched from their smallest to their largest value.
cv::Mat to_eight_bits(const cv::Mat& image) {
  if (image.depth() == CV_8U) return image;
  if (image.depth() == CV_16U) {
    const auto [low, high] = range_of(image);
    const double gain = high > low ? 255.0 / (high - low) : 0.0;
    cv::Mat out;
    image.convertTo(out, CV_8U, gain, -low * gain);
    return out;
  }
  cv::Mat flat;
  image.convertTo(flat, CV_32F);
  cv::patchNaNs(flat, 0.0);
  double low = 0.0;
  double high = 0.0;
  cv::minMaxLoc(flat.reshape(1), &low, &high);
  const double gain = high > low ? 255.0 / (high - low) : 0.0;
  cv::Mat out;
  flat.convertTo(out, CV_8U, gain, -low * gain);
  return out;
}

/// Contrast of a small picture between its two halves by Otsu.
double contrast_of(const cv::Mat& small) {
  const Split split = otsu(histogram_of(small));
  return split.high_mean - split.low_mean;
}

/// Distance of each pixel's colour from `background`, 0 to 255.
cv::Mat colour_distance(const cv::Mat& bgr, const cv::Scalar& background) {
  cv::Mat distance;
  cv::absdiff(bgr, background, distance);
  cv::Mat out(bgr.size(), CV_8U);
  for (int y = 0; y < bgr.rows; ++y) {
    const auto* in = distance.ptr<cv::Vec3b>(y);
    auto* to = out.ptr<unsigned char>(y);
    for (int x = 0; x < bgr.cols; ++x) {
      const float b = in[x][0];
      const float g = in[x][1];
      const float r = in[x][2];
      to[x] = cv::saturate_cast<unsigned char>(std::sqrt((b * b + g * g + r * r) / 3.0F));
    }
  }
  return out;
}

/// A red mark on skin or green on grey shows in colour only. Looked at in small; `plane` is made when colour
/// tells drawing from background much better than brightness does.
bool colour_says_more(const cv::Mat& bgr, cv::Mat& plane) {
  cv::Mat small;
  cv::resize(bgr, small, {std::min(bgr.cols, 160), std::min(bgr.rows, 120)}, 0, 0, cv::INTER_AREA);
  std::array<std::vector<unsigned char>, 3> border;
  double colourful = 0.0;
  for (int y = 0; y < small.rows; ++y) {
    for (int x = 0; x < small.cols; ++x) {
      const auto& p = small.at<cv::Vec3b>(y, x);
      colourful += std::abs(p[0] - p[2]) + std::abs(p[1] - p[2]);
      if (x > 1 && y > 1 && x + 2 < small.cols && y + 2 < small.rows) continue;
      for (int c = 0; c < 3; ++c) border[c].push_back(p[c]);
    }
  }
  if (colourful < 1.5 * static_cast<double>(small.total())) return false;
  cv::Scalar background;
  for (int c = 0; c < 3; ++c) {
    std::nth_element(border[c].begin(), border[c].begin() + border[c].size() / 2, border[c].end());
    background[c] = border[c][border[c].size() / 2];
  }
  cv::Mat grey;
  cv::cvtColor(small, grey, cv::COLOR_BGR2GRAY);
  if (contrast_of(colour_distance(small, background)) < 1.6 * contrast_of(grey) + 5.0) return false;
  plane = colour_distance(bgr, background);
  return true;
}

}  // namespace

tl::expected<cv::Mat, std::string> grey_plane(const cv::Mat& image) {
  if (image.empty()) return tl::unexpected<std::string>("the picture is empty");
  if (image.dims != 2 || image.cols < kMinSide_px || image.rows < kMinSide_px) {
    return tl::unexpected(fmt::format("the picture has only {} x {} pixels; at least {} x {} are needed",
                                      image.cols, image.rows, kMinSide_px, kMinSide_px));
  }
  const cv::Mat bits = to_eight_bits(image);
  cv::Mat grey;
  switch (bits.channels()) {
    case 1:
      return bits;
    case 3:
      if (colour_says_more(bits, grey)) return grey;
      cv::cvtColor(bits, grey, cv::COLOR_BGR2GRAY);
      return grey;
    case 4: {
      cv::cvtColor(bits, grey, cv::COLOR_BGRA2GRAY);
      cv::Mat alpha;
      cv::extractChannel(bits, alpha, 3);
      // White where nothing was painted; a white drawing on nothing is its own alpha.
      cv::Mat painted;
      cv::multiply(255 - grey, alpha, painted, 1.0 / 255.0);
      double low = 0.0;
      double high = 0.0;
      cv::minMaxLoc(painted, &low, &high);
      if (high - low >= 8.0) return cv::Mat(255 - painted);
      return cv::Mat(255 - alpha);
    }
    default:
      return tl::unexpected(
          fmt::format("the picture has {} channels; 1, 3 or 4 are understood", bits.channels()));
  }
}

cv::Mat colour_plane(const cv::Mat& image) {
  if (image.empty() || image.dims != 2) return {};
  const cv::Mat bits = to_eight_bits(image);
  cv::Mat out;
  switch (bits.channels()) {
    case 1:
      cv::cvtColor(bits, out, cv::COLOR_GRAY2BGR);
      return out;
    case 3:
      return bits;
    case 4: {
      cv::Mat alpha;
      cv::extractChannel(bits, alpha, 3);
      cv::cvtColor(bits, out, cv::COLOR_BGRA2BGR);
      cv::cvtColor(alpha, alpha, cv::COLOR_GRAY2BGR);
      cv::multiply(out, alpha, out, 1.0 / 255.0);
      cv::subtract(cv::Scalar::all(255), alpha, alpha);
      cv::add(out, alpha, out);
      return out;
    }
    default:
      return {};
  }
}

}  // namespace telekerf::vision
