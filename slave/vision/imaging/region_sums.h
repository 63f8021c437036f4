// SPDX-License-Identifier: Apache-2.0
// Sums of grey levels and of their squares, tile by tile: exact whole numbers, additive over rows and strips.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace telekerf::imaging {

/// A region is judged in kTileRows x kTileColumns tiles.
inline constexpr int kTileRows = 8;
inline constexpr int kTileColumns = 8;
inline constexpr std::size_t kTiles = std::size_t{kTileRows} * kTileColumns;

/// Of some pixels: how many, their sum, the sum of their squares.
struct GreySums {
  std::uint64_t pixels = 0;
  std::uint64_t sum = 0;
  std::uint64_t squares = 0;

  GreySums& operator+=(const GreySums& more) noexcept {
    pixels += more.pixels;
    sum += more.sum;
    squares += more.squares;
    return *this;
  }
  bool operator==(const GreySums&) const = default;
  /// Grey levels; 0 of none.
  double mean() const noexcept;
  /// Grey levels squared, of all pixels (not of a sample); 0 of none.
  double variance() const noexcept;
};

/// Of an 8-bit picture of one channel, or a part of one.
GreySums grey_sums(const cv::Mat& grey);

/// The tiles of a region of 8-bit grey levels, row by row as a camera delivers them.
class RegionSums {
 public:
  /// Of a region of `width` x `height` pixels, at least a tile's count in each direction.
  RegionSums(int width, int height);

  /// The next rows of the region, as wide as it; rows beyond its height are left out.
  void add_rows(const cv::Mat& rows);
  int rows() const noexcept { return rows_; }

  /// Tiles row by row.
  const std::array<GreySums, kTiles>& tiles() const noexcept { return tiles_; }
  GreySums all() const noexcept;

 private:
  int width_;
  int height_;
  int rows_ = 0;
  std::array<GreySums, kTiles> tiles_{};
};

/// Of a whole region at once.
std::array<GreySums, kTiles> tile_sums(const cv::Mat& region);

/// Bounds of tile `i` of `count` over `length` pixels: the first pixel of it, and of the next.
inline int tile_begin(int i, int count, int length) noexcept { return i * length / count; }

}  // namespace telekerf::imaging
