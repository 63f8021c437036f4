// SPDX-License-Identifier: Apache-2.0
// How sharp a region of a picture is: normalised variance (eq. 155), which is seen from far off and finds,
// and Tenengrad, which is steep near the peak and fixes.
//
// What is not the object's is taken out: noise (half of the difference of two pictures at rest), the flat
// field (each tile is divided by its own mean; what the light varies within a tile is subtracted), and single
// specks of dust (the few tiles that stand out most are left out).
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "slave/vision/imaging/region_sums.h"

namespace telekerf::imaging {

/// Tiles that are left out of the mean, those of the largest values: what a few specks of dust take.
inline constexpr std::size_t kTrimmedTiles = 10;

/// (1 / (H W mu)) sum (i - mu)^2, as printed (eq. 155), grey levels; 0 where nothing shines.
double normalised_variance(const GreySums& sums) noexcept;

/// What of a tile's variance is not the object's.
struct Background {
  double noise_variance = 0.0;        ///< grey levels squared, of one pixel
  std::array<double, kTiles> flat{};  ///< variance of the light within each tile over the square of its mean
};

struct Sharpness {
  /// Mean over the tiles of (variance - noise) / mean^2 - flat: gain and light do not count. Not below 0.
  double variance = 0.0;
  /// Mean over the tiles of the squared gradient (Sobel, grey levels a pixel x 8) / mean^2, noise subtracted.
  double tenengrad = 0.0;
  double variance_deviation = 0.0;     ///< standard deviation that the noise gives `variance`
  double tenengrad_deviation = 0.0;    ///< likewise
  double mean = 0.0;                   ///< grey levels
  std::array<double, kTiles> tiles{};  ///< `variance` of each tile
};

/// The part of a picture that is judged: `share` of its width and height about the middle.
cv::Rect central_region(const cv::Size& picture, double share) noexcept;

/// Of a region of 8-bit grey levels. `with_tenengrad` false: that stays 0, and one pass is enough.
Sharpness sharpness_of(const cv::Mat& region, const Background& background, bool with_tenengrad = true);

/// Two pictures of the same place with nothing moved in between.
struct RestPair {
  double noise_variance = 0.0;  ///< grey levels squared, of one picture's pixel
  /// How much wider than a pixel the difference's structure is: the variance of its means over small blocks,
  /// times their pixels, over that of its pixels, less 1, in standard deviations of what noise gives. The
  /// object is wider than a pixel, and so is what its motion leaves.
  double coherence_deviations = 0.0;
  bool moved() const noexcept { return coherence_deviations > 6.0; }
};
RestPair compare_at_rest(const cv::Mat& a, const cv::Mat& b);

/// Variance within each tile over the square of its mean, of a flat field: a region of light alone.
std::array<double, kTiles> flat_of(const cv::Mat& light);

}  // namespace telekerf::imaging
