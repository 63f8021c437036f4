// SPDX-License-Identifier: Apache-2.0
#include "common/vision/raster/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "common/vision/raster/light.h"

namespace telekerf::vision {
namespace {

constexpr int kSmallestSide = 8;

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

std::array<double, 256> histogram_of(const cv::Mat& plane) {
  // A quarter of a large picture's rows says as much: other ones in each stretch of columns, so that a level
  // line is not missed. Four counters in turn, so that equal neighbours don't wait for each other.
  constexpr int kStretch = 64;
  const int step = plane.rows >= 1000 ? 4 : 1;
  std::array<std::array<std::uint32_t, 256>, 4> counts{};
  for (int y = 0; y < plane.rows; ++y) {
    const auto* row = plane.ptr<unsigned char>(y);
    for (int first = y % step * kStretch; first < plane.cols; first += step * kStretch) {
      const int end = std::min(first + kStretch, plane.cols);
      int x = first;
      for (; x + 4 <= end; x += 4) {
        for (int k = 0; k < 4; ++k) ++counts[k][row[x + k]];
      }
      for (; x < end; ++x) ++counts[0][row[x]];
    }
  }
  std::array<double, 256> out{};
  for (int i = 0; i < 256; ++i) out[i] = double(counts[0][i]) + counts[1][i] + counts[2][i] + counts[3][i];
  return out;
}

/// Otsu's split: the level that leaves the least variance within the two classes, and the classes' means.
struct Split {
  double level = 0.0;
  double low_mean = 0.0;
  double high_mean = 0.0;
  bool clear = false;  ///< two large classes, each of next to one grey level
};

Split otsu(const std::array<double, 256>& counts) {
  constexpr double kSmallest = 0.05;  // share of a large class
  constexpr double kBetween = 0.9;    // share of all variance
  double total = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < 256; ++i) {
    total += counts[i];
    sum += i * counts[i];
    squares += double(i) * i * counts[i];
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
      const bool large = std::min(below, above) > kSmallest * total;
      best = {i + 0.5, low, high, large && between > kBetween * (squares * total - sum * sum)};
    }
  }
  return best;
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

/// Grey level below which `share` of the counts from `first` to `last` lie.
double percentile(const std::array<double, 256>& counts, int first, int last, double share) {
  double total = 0.0;
  for (int i = first; i <= last; ++i) total += counts[i];
  double seen = 0.0;
  for (int i = first; i <= last; ++i) {
    if (counts[i] > 0.0 && seen + counts[i] >= share * total)
      return i + (share * total - seen) / counts[i] - 0.5;
    seen += counts[i];
  }
  return last;
}

/// Drawing against a background that is known to be the larger part: what lies six deviations of the noise
/// off it. Lines of one pixel are too few for a split of the histogram.
bool separate_from_background(const std::array<double, 256>& counts, double background, double noise,
                              Field& field) {
  const int reach = static_cast<int>(std::ceil(6.0 * noise + 4.0));
  const int middle = static_cast<int>(std::lround(background));
  constexpr double kFewest = 2e-4;  // of the picture: what a drawing's darkest part covers at least
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
  const auto level_at = [&](double share) {
    return field.dark ? percentile(counts, 0, std::max(0, middle - reach), share)
                      : percentile(counts, std::min(255, middle + reach), 255, 1.0 - share);
  };
  const double off_background = (field.dark ? dark_count : light_count);
  const double fifth = std::abs(background - level_at(0.2));
  const double furthest = std::abs(background - level_at(std::min(1.0, kFewest * total / off_background)));
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

Field inverted(const Field& field) {
  Field out = field;
  out.dark = !field.dark;
  out.drawn = cv::Mat();  // a copied field shares its planes
  cv::bitwise_not(field.drawn, out.drawn);
  return out;
}

}  // namespace telekerf::vision
