// SPDX-License-Identifier: Apache-2.0
#include "common/vision/raster/field.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "common/vision/raster/levels.h"
#include "common/vision/raster/light.h"

namespace telekerf::vision {
bool border_is_dark(const cv::Mat& smooth, double level) {
  int dark = 0;
  const int rows = smooth.rows;
  const int cols = smooth.cols;
  for (int x = 0; x < cols; ++x) {
    dark += (smooth.at<unsigned char>(0, x) < level) + (smooth.at<unsigned char>(rows - 1, x) < level);
  }
  for (int y = 0; y < rows; ++y) {
    dark += (smooth.at<unsigned char>(y, 0) < level) + (smooth.at<unsigned char>(y, cols - 1) < level);
  }
  return dark >= rows + cols;
}

double noise_of(const cv::Mat& grey) {
  // |1 -2 1; -2 4 -2; 1 -2 1|: blind to planes and straight edges; its standard deviation is 6 sigma.
  std::array<double, 2048> counts{};
  double total = 0.0;
  const int step = std::max(1, grey.rows / 80);
  for (int y = 1; y + 1 < grey.rows; y += step) {
    const auto* a = grey.ptr<unsigned char>(y - 1);
    const auto* b = grey.ptr<unsigned char>(y);
    const auto* c = grey.ptr<unsigned char>(y + 1);
    for (int x = 1; x + 1 < grey.cols; x += 3) {
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

namespace {

/// Drawing against a background that is known to be the larger part: what lies six deviations of the noise
/// off it. Lines of one pixel are too few for a split of the histogram.
bool separate_from_background(const Histogram& counts, double background, double noise, Field& field) {
  const int reach = static_cast<int>(std::ceil(6.0 * noise + 4.0));
  const int middle = static_cast<int>(std::lround(background));
  constexpr double kMinDarkest = 2e-4;  // of the picture: what a drawing's darkest part covers at least
  double dark = 0.0;
  double light = 0.0;
  double dark_count = 0.0;
  double light_count = 0.0;
  double total = 0.0;
  for (int i = 0; i < 256; ++i) {
    total += counts[i];
    if (i < middle - reach) dark_count += counts[i];
    if (i > middle + reach) light_count += counts[i];
    if (i < middle - reach) dark += counts[i] * (middle - i);
    if (i > middle + reach) light += counts[i] * (i - middle);
  }
  if (dark + light < 1e-5 * total * reach) return false;
  field.dark = dark >= light;
  // The ink's own level: its darker fifth, which thin lines reach only in their middle. Where the paper is
  // uneven, a thin line is but the far end of all that lies off the background.
  const auto level_at = [&](double fraction) {
    return field.dark ? percentile(counts, 0, std::max(0, middle - reach), fraction)
                      : percentile(counts, std::min(255, middle + reach), 255, 1.0 - fraction);
  };
  const double off_background = (field.dark ? dark_count : light_count);
  const double fifth = std::abs(background - level_at(0.2));
  const double furthest =
      std::abs(background - level_at(std::min(1.0, kMinDarkest * total / off_background)));
  field.contrast = furthest > 4.0 * fifth ? furthest : fifth;
  const double off = std::max(0.5 * field.contrast, static_cast<double>(reach) - 1.0);
  field.level = std::floor(background + (field.dark ? -off : off)) + 0.5;
  return true;
}

/// Smooths and finds the level half way between drawing and background, where a blurred border lies.
void separate(const cv::Mat& grey, double sigma_px, const std::optional<Light>& light, Field& field) {
  field.sigma_px = sigma_px;
  const int size = 2 * static_cast<int>(std::ceil(2.0 * sigma_px)) + 1;
  cv::GaussianBlur(grey, field.smooth, {size, size}, sigma_px, sigma_px, cv::BORDER_REPLICATE);
  auto counts = histogram_of(field.smooth);
  Split halves = otsu(counts);
  // A large faint region looks like a change of light; two grey levels with nothing between are no such
  // thing.
  if (light && !halves.clear) {
    if (change_of(*light) > 3.0) {
      field.smooth = flattened(field.smooth, *light);
      counts = histogram_of(field.smooth);
    }
    const double noise = field.noise / (2.0 * sigma_px * std::sqrt(M_PI));
    if (separate_from_background(counts, (*light)[0], noise, field)) return;
    halves = otsu(counts);
  }
  const int split = static_cast<int>(halves.level);
  // The background is what most of the picture's border shows.
  field.dark = !border_is_dark(field.smooth, split + 0.5);
  const double low = percentile(counts, 0, split, field.dark ? 0.2 : 0.5);
  const double high = percentile(counts, split + 1, 255, field.dark ? 0.5 : 0.8);
  field.contrast =
      halves.high_mean > halves.low_mean ? std::max(0.0, high - low) : 0.0;  // 0: one grey level only
  field.level = std::floor(0.5 * (low + high)) + 0.5;                        // no pixel lies on it
}

}  // namespace

tl::expected<Field, std::string> make_field(const cv::Mat& grey) {
  Field field;
  field.noise = noise_of(grey);
  const auto light = light_of(grey, field.noise);
  separate(grey, 1.0, light, field);
  if (field.noise > 0.08 * field.contrast && field.noise > 1.0) separate(grey, 1.6, light, field);
  double smoothed_noise = field.noise / (2.0 * field.sigma_px * std::sqrt(M_PI));
  if (field.contrast > 6.0 * smoothed_noise && field.contrast < 14.0 * smoothed_noise + 8.0 &&
      field.noise > 1.0) {
    separate(grey, 2.6, light, field);
    smoothed_noise = field.noise / (2.0 * field.sigma_px * std::sqrt(M_PI));
  }
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

  cv::threshold(field.smooth, field.drawn, std::floor(field.level), 255,
                field.dark ? cv::THRESH_BINARY_INV : cv::THRESH_BINARY);
  return field;
}

Field at_share(const Field& field, double share) {
  Field out = field;
  const double nearer = (0.5 - share) * field.contrast;  // to the background
  out.level = std::floor(std::clamp(field.level + (field.dark ? nearer : -nearer), 1.0, 254.0)) + 0.5;
  out.drawn = cv::Mat();  // a copied field shares its planes
  cv::threshold(out.smooth, out.drawn, std::floor(out.level), 255,
                out.dark ? cv::THRESH_BINARY_INV : cv::THRESH_BINARY);
  return out;
}

Field inverted(const Field& field) {
  Field out = field;
  out.dark = !field.dark;
  out.drawn = cv::Mat();  // a copied field shares its planes
  cv::bitwise_not(field.drawn, out.drawn);
  return out;
}

}  // namespace telekerf::vision
