// SPDX-License-Identifier: Apache-2.0
#include "common/vision/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace telekerf::vision {
namespace {

constexpr int kSmallestSide = 8;

/// Any depth -> 8 bits; more than 8 bits are stretched from their smallest to their largest value.
cv::Mat to_eight_bits(const cv::Mat& image) {
  if (image.depth() == CV_8U) return image;
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

std::array<double, 256> histogram_of(const cv::Mat& plane) {
  std::array<double, 256> counts{};
  for (int y = 0; y < plane.rows; ++y) {
    const auto* row = plane.ptr<unsigned char>(y);
    for (int x = 0; x < plane.cols; ++x) counts[row[x]] += 1.0;
  }
  return counts;
}

/// Otsu's split: the level that leaves the least variance within the two classes, and the classes' means.
struct Split {
  double level = 0.0;
  double low_mean = 0.0;
  double high_mean = 0.0;
};

Split otsu(const std::array<double, 256>& counts) {
  double total = 0.0;
  double sum = 0.0;
  for (int i = 0; i < 256; ++i) {
    total += counts[i];
    sum += i * counts[i];
  }
  Split best;
  double most = -1.0;
  double below = 0.0;
  double below_sum = 0.0;
  for (int i = 0; i < 255; ++i) {
    below += counts[i];
    below_sum += i * counts[i];
    const double above = total - below;
    if (below <= 0.0 || above <= 0.0) continue;
    const double low = below_sum / below;
    const double high = (sum - below_sum) / above;
    const double between = below * above * (high - low) * (high - low);
    if (between > most) {
      most = between;
      best = {i + 0.5, low, high};
    }
  }
  return best;
}

}  // namespace

tl::expected<cv::Mat, std::string> grey_plane(const cv::Mat& image) {
  if (image.empty()) return tl::unexpected<std::string>("the picture is empty");
  if (image.dims != 2 || image.cols < kSmallestSide || image.rows < kSmallestSide) {
    return tl::unexpected(fmt::format("the picture has only {} x {} pixels; at least {} x {} are needed",
                                      image.cols, image.rows, kSmallestSide, kSmallestSide));
  }
  const cv::Mat bits = to_eight_bits(image);
  cv::Mat grey;
  switch (bits.channels()) {
    case 1:
      return bits;
    case 3:
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

double noise_of(const cv::Mat& grey) {
  // |1 -2 1; -2 4 -2; 1 -2 1|: blind to planes and straight edges; its standard deviation is 6 sigma.
  std::array<double, 2048> counts{};
  double total = 0.0;
  const int step = std::max(1, grey.rows / 256);
  for (int y = 1; y + 1 < grey.rows; y += step) {
    const auto* a = grey.ptr<unsigned char>(y - 1);
    const auto* b = grey.ptr<unsigned char>(y);
    const auto* c = grey.ptr<unsigned char>(y + 1);
    for (int x = 1; x + 1 < grey.cols; x += 2) {
      const int v = a[x - 1] - 2 * a[x] + a[x + 1] - 2 * (b[x - 1] - 2 * b[x] + b[x + 1]) + c[x - 1] -
                    2 * c[x] + c[x + 1];
      counts[std::min(std::abs(v), 2047)] += 1.0;
      total += 1.0;
    }
  }
  double seen = 0.0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    seen += counts[i];
    if (seen >= 0.5 * total) {
      // Half a count back within the bin; a clean picture has its median in bin 0 and no noise.
      const double median = i == 0 ? 0.0 : static_cast<double>(i) - (seen - 0.5 * total) / counts[i] + 0.5;
      return median / (0.6745 * 6.0);
    }
  }
  return 0.0;
}

tl::expected<Field, std::string> make_field(const cv::Mat& grey) {
  Field field;
  field.noise = noise_of(grey);
  field.sigma_px = field.noise > 3.0 ? 1.5 : 1.0;
  cv::GaussianBlur(grey, field.smooth, {}, field.sigma_px, field.sigma_px, cv::BORDER_REPLICATE);

  const auto counts = histogram_of(field.smooth);
  const Split split = otsu(counts);
  // Otsu's level leans towards the larger class's spread; the half-way level is where a blurred edge lies.
  // Between two whole grey levels, so that no pixel lies on it.
  field.level = std::floor(0.5 * (split.low_mean + split.high_mean)) + 0.5;
  field.contrast = split.high_mean - split.low_mean;
  const double smoothed_noise = field.noise / (2.0 * field.sigma_px * std::sqrt(M_PI));
  // Two halves of plain noise are 1.6 standard deviations apart.
  if (field.contrast < 6.0) {
    return tl::unexpected(fmt::format(
        "the picture is uniform (contrast {:.1f} of 255); there is no contour in it", field.contrast));
  }
  if (field.contrast < 6.0 * smoothed_noise) {
    return tl::unexpected(
        fmt::format("the picture is noise (contrast {:.1f}, noise {:.1f} grey levels); there is no "
                    "contour in it",
                    field.contrast, field.noise));
  }

  // The background is what most of the picture's border shows.
  int dark_border = 0;
  const int rows = field.smooth.rows;
  const int cols = field.smooth.cols;
  for (int x = 0; x < cols; ++x) {
    dark_border += (field.smooth.at<unsigned char>(0, x) < field.level) +
                   (field.smooth.at<unsigned char>(rows - 1, x) < field.level);
  }
  for (int y = 0; y < rows; ++y) {
    dark_border += (field.smooth.at<unsigned char>(y, 0) < field.level) +
                   (field.smooth.at<unsigned char>(y, cols - 1) < field.level);
  }
  field.dark = dark_border < rows + cols;
  cv::threshold(field.smooth, field.drawn, std::floor(field.level), 255,
                field.dark ? cv::THRESH_BINARY_INV : cv::THRESH_BINARY);
  return field;
}

}  // namespace telekerf::vision
