// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/sharpness.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <opencv2/imgproc.hpp>

namespace telekerf::imaging {
namespace {

/// Below this mean a tile is black: its variance says nothing of contrast.
constexpr double kBlack = 1.0;
/// Sum of the squares of both Sobel kernels: what white noise of variance 1 makes of the squared gradient.
constexpr double kSobelNoise = 24.0;
/// Neighbouring gradients share pixels: that many count as one.
constexpr double kSobelShared = 4.0;

/// The mean without the largest kTrimmedTiles.
double trimmed_mean(std::array<double, kTiles> values) noexcept {
  constexpr std::size_t kKept = kTiles - kTrimmedTiles;
  std::nth_element(values.begin(), values.begin() + kKept, values.end());
  return std::accumulate(values.begin(), values.begin() + kKept, 0.0) / static_cast<double>(kKept);
}

/// Sum of the squared Sobel gradients of the pixels x in [left, right) of a row and its neighbours.
std::uint64_t gradient_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
                           int left, int right) noexcept {
  std::uint64_t sum = 0;
  for (int x = left; x < right; ++x) {
    const int across =
        above[x + 1] - above[x - 1] + 2 * (here[x + 1] - here[x - 1]) + below[x + 1] - below[x - 1];
    const int down = below[x - 1] - above[x - 1] + 2 * (below[x] - above[x]) + below[x + 1] - above[x + 1];
    sum += static_cast<std::uint32_t>(across * across + down * down);
  }
  return sum;
}

/// Mean squared gradient of each tile; the region's outermost pixels have none.
std::array<double, kTiles> gradients(const cv::Mat& region) {
  std::array<double, kTiles> out{};
  for (int row = 0; row < kTileRows; ++row) {
    const int top = std::max(1, tile_begin(row, kTileRows, region.rows));
    const int bottom = std::min(region.rows - 1, tile_begin(row + 1, kTileRows, region.rows));
    for (int column = 0; column < kTileColumns; ++column) {
      const int left = std::max(1, tile_begin(column, kTileColumns, region.cols));
      const int right = std::min(region.cols - 1, tile_begin(column + 1, kTileColumns, region.cols));
      std::uint64_t sum = 0;
      for (int y = top; y < bottom; ++y) {
        sum += gradient_row(region.ptr(y - 1), region.ptr(y), region.ptr(y + 1), left, right);
      }
      const int pixels = std::max(1, (bottom - top) * (right - left));
      out[static_cast<std::size_t>(row * kTileColumns + column)] = static_cast<double>(sum) / pixels;
    }
  }
  return out;
}

double square(double x) noexcept { return x * x; }

}  // namespace

double normalised_variance(const GreySums& sums) noexcept {
  const double mean = sums.mean();
  return mean > 0.0 ? sums.variance() / mean : 0.0;
}

cv::Rect central_region(const cv::Size& picture, double share) noexcept {
  const int width =
      std::clamp(static_cast<int>(share * picture.width), std::min(picture.width, 64), picture.width);
  const int height =
      std::clamp(static_cast<int>(share * picture.height), std::min(picture.height, 64), picture.height);
  return {(picture.width - width) / 2, (picture.height - height) / 2, width, height};
}

Sharpness sharpness_of(const cv::Mat& region, const Background& background, bool with_tenengrad) {
  const auto sums = tile_sums(region);
  Sharpness out;
  double pixels = 0.0;
  for (std::size_t i = 0; i < kTiles; ++i) {
    const double mean = sums[i].mean();
    out.mean += mean / kTiles;
    pixels += static_cast<double>(sums[i].pixels);
    if (mean < kBlack) continue;
    out.tiles[i] = (sums[i].variance() - background.noise_variance) / square(mean) - background.flat[i];
  }
  out.variance = std::max(0.0, trimmed_mean(out.tiles));
  if (out.mean < kBlack) return out;
  const double noise = background.noise_variance / square(out.mean);
  out.variance_deviation = std::sqrt((2.0 * square(noise) + 4.0 * noise * out.variance) / pixels);
  if (!with_tenengrad) return out;

  std::array<double, kTiles> slopes = gradients(region);
  for (std::size_t i = 0; i < kTiles; ++i) {
    const double mean = sums[i].mean();
    slopes[i] = mean < kBlack ? 0.0 : (slopes[i] - kSobelNoise * background.noise_variance) / square(mean);
  }
  out.tenengrad = std::max(0.0, trimmed_mean(slopes));
  const double gradient_noise = 0.5 * kSobelNoise * noise;
  out.tenengrad_deviation = std::sqrt(kSobelShared / pixels *
                                      (4.0 * square(gradient_noise) + 4.0 * gradient_noise * out.tenengrad));
  return out;
}

RestPair compare_at_rest(const cv::Mat& a, const cv::Mat& b) {
  CV_Assert(a.type() == CV_8UC1 && b.type() == CV_8UC1 && a.size() == b.size());
  // The light may have changed between the two: as a whole it is no movement.
  const double gain = grey_sums(a).mean() / std::max(1.0, grey_sums(b).mean());
  cv::Mat difference;
  cv::addWeighted(a, 1.0, b, -gain, 0.0, difference, CV_32F);
  const double variance = difference.dot(difference) / static_cast<double>(difference.total());
  RestPair out;
  out.noise_variance = 0.5 * variance;
  if (variance == 0.0) return out;
  for (const int block : {2, 8}) {  // fine structure, and blurred structure
    cv::Mat means;
    const cv::Size blocks(a.cols / block, a.rows / block);
    if (blocks.empty()) continue;
    cv::resize(difference(cv::Rect(0, 0, blocks.width * block, blocks.height * block)), means, blocks, 0, 0,
               cv::INTER_AREA);
    const auto count = static_cast<double>(means.total());
    const double coherence = square(block) * means.dot(means) / count / variance;
    out.coherence_deviations = std::max(out.coherence_deviations, (coherence - 1.0) / std::sqrt(2.0 / count));
  }
  return out;
}

std::array<double, kTiles> flat_of(const cv::Mat& light) {
  cv::Mat fine;
  light.convertTo(fine, CV_64F);
  std::array<double, kTiles> out{};
  for (int row = 0; row < kTileRows; ++row) {
    for (int column = 0; column < kTileColumns; ++column) {
      double sum = 0.0;
      double squares = 0.0;
      int pixels = 0;
      for (int y = tile_begin(row, kTileRows, fine.rows); y < tile_begin(row + 1, kTileRows, fine.rows);
           ++y) {
        for (int x = tile_begin(column, kTileColumns, fine.cols);
             x < tile_begin(column + 1, kTileColumns, fine.cols); ++x, ++pixels) {
          sum += fine.at<double>(y, x);
          squares += square(fine.at<double>(y, x));
        }
      }
      const double mean = sum / std::max(1, pixels);
      out[static_cast<std::size_t>(row * kTileColumns + column)] =
          mean > 0.0 ? std::max(0.0, squares / std::max(1, pixels) / square(mean) - 1.0) : 0.0;
    }
  }
  return out;
}

}  // namespace telekerf::imaging
