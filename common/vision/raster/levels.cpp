// SPDX-License-Identifier: Apache-2.0
#include "common/vision/raster/levels.h"

#include <algorithm>
#include <cstdint>

namespace telekerf::vision {

Histogram histogram_of(const cv::Mat& plane) {
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
  Histogram out{};
  for (int i = 0; i < 256; ++i) out[i] = double(counts[0][i]) + counts[1][i] + counts[2][i] + counts[3][i];
  return out;
}

Split otsu(const Histogram& counts) {
  constexpr double kSmallest = 0.05;  // fraction of a large class
  constexpr double kBetween = 0.9;    // of all variance
  double total = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < 256; ++i) {
    total += counts[i];
    sum += i * counts[i];
    squares += double(i) * i * counts[i];
  }
  Split best;
  double largest = -1.0;
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
    if (between > largest) {
      largest = between;
      const bool large = std::min(below, above) > kSmallest * total;
      best = {i + 0.5, low, high, large && between > kBetween * (squares * total - sum * sum)};
    }
  }
  return best;
}

double percentile(const Histogram& counts, int first, int last, double fraction) {
  double total = 0.0;
  for (int i = first; i <= last; ++i) total += counts[i];
  double seen = 0.0;
  for (int i = first; i <= last; ++i) {
    if (counts[i] > 0.0 && seen + counts[i] >= fraction * total)
      return i + (fraction * total - seen) / counts[i] - 0.5;
    seen += counts[i];
  }
  return last;
}

}  // namespace telekerf::vision
