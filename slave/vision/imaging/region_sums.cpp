// SPDX-License-Identifier: Apache-2.0
#include "slave/vision/imaging/region_sums.h"

#include <algorithm>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace telekerf::imaging {
namespace {

struct Block {
  const std::uint8_t* first;
  std::size_t stride;  ///< bytes from row to row
  int width;
  int height;
};

GreySums plain_sums(const Block& block) noexcept {
  GreySums out;
  for (int y = 0; y < block.height; ++y) {
    const std::uint8_t* row = block.first + static_cast<std::size_t>(y) * block.stride;
    for (int x = 0; x < block.width; ++x) {
      out.sum += row[x];
      out.squares += std::uint64_t{row[x]} * row[x];
    }
  }
  return out;
}

#if defined(__x86_64__)

/// Rows after which the 32-bit lanes of squares are emptied: a lane takes 2 x 255^2 a step, and a row of
/// kWidest pixels has kWidest / 16 steps.
constexpr int kWidest = 4096;
constexpr int kRowsAtOnce = 32;
static_assert(std::int64_t{kWidest} / 16 * kRowsAtOnce * 2 * 255 * 255 < INT32_MAX);

__attribute__((target("avx2"))) std::uint64_t all_of(__m256i lanes64) noexcept {
  alignas(32) std::uint64_t lane[4];
  _mm256_store_si256(reinterpret_cast<__m256i*>(lane), lanes64);
  return lane[0] + lane[1] + lane[2] + lane[3];
}

__attribute__((target("avx2"))) GreySums wide_sums(const Block& block) noexcept {
  const __m256i zero = _mm256_setzero_si256();
  __m256i sums = zero;
  __m256i squares = zero;
  GreySums rest;
  const int whole = block.width / 32 * 32;
  for (int first = 0; first < block.height; first += kRowsAtOnce) {
    __m256i low = zero;
    __m256i high = zero;
    for (int y = first; y < std::min(first + kRowsAtOnce, block.height); ++y) {
      const std::uint8_t* row = block.first + static_cast<std::size_t>(y) * block.stride;
      for (int x = 0; x < whole; x += 32) {
        const __m256i grey = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(row + x));
        sums = _mm256_add_epi64(sums, _mm256_sad_epu8(grey, zero));
        const __m256i even = _mm256_unpacklo_epi8(grey, zero);
        const __m256i odd = _mm256_unpackhi_epi8(grey, zero);
        low = _mm256_add_epi32(low, _mm256_madd_epi16(even, even));
        high = _mm256_add_epi32(high, _mm256_madd_epi16(odd, odd));
      }
    }
    for (const __m256i& lanes : {low, high}) {
      squares = _mm256_add_epi64(squares, _mm256_unpacklo_epi32(lanes, zero));
      squares = _mm256_add_epi64(squares, _mm256_unpackhi_epi32(lanes, zero));
    }
  }
  if (whole < block.width) {
    rest = plain_sums({block.first + whole, block.stride, block.width - whole, block.height});
  }
  return {0, rest.sum + all_of(sums), rest.squares + all_of(squares)};
}

const bool kWide = __builtin_cpu_supports("avx2") != 0;

#endif

GreySums block_sums(const Block& block) noexcept {
#if defined(__x86_64__)
  GreySums out = kWide && block.width <= kWidest ? wide_sums(block) : plain_sums(block);
#else
  GreySums out = plain_sums(block);
#endif
  out.pixels = static_cast<std::uint64_t>(block.width) * static_cast<std::uint64_t>(block.height);
  return out;
}

}  // namespace

double GreySums::mean() const noexcept {
  return pixels == 0 ? 0.0 : static_cast<double>(sum) / static_cast<double>(pixels);
}

double GreySums::variance() const noexcept {
  if (pixels == 0) return 0.0;
  // n sum(x^2) - (sum x)^2 is a whole number: nothing cancels.
  __extension__ using Wide = unsigned __int128;
  const Wide difference = Wide{pixels} * squares - Wide{sum} * sum;
  const auto n = static_cast<double>(pixels);
  return static_cast<double>(difference) / n / n;
}

GreySums grey_sums(const cv::Mat& grey) {
  CV_Assert(grey.type() == CV_8UC1);
  GreySums out;
  for (int x = 0; x < grey.cols; x += 4096)
    out += block_sums({grey.ptr<std::uint8_t>() + x, grey.step[0], std::min(4096, grey.cols - x), grey.rows});
  return out;
}

RegionSums::RegionSums(int width, int height) : width_(width), height_(height) {
  CV_Assert(width >= kTileColumns && height >= kTileRows);
}

void RegionSums::add_rows(const cv::Mat& rows) {
  CV_Assert(rows.type() == CV_8UC1 && rows.cols == width_);
  const int end = std::min(height_, rows_ + rows.rows);
  const int first = rows_;
  for (int tile_row = 0; tile_row < kTileRows; ++tile_row) {
    const int top = std::max(first, tile_begin(tile_row, kTileRows, height_));
    const int bottom = std::min(end, tile_begin(tile_row + 1, kTileRows, height_));
    if (top >= bottom) continue;
    for (int column = 0; column < kTileColumns; ++column) {
      const int left = tile_begin(column, kTileColumns, width_);
      const int right = tile_begin(column + 1, kTileColumns, width_);
      tiles_[static_cast<std::size_t>(tile_row * kTileColumns + column)] +=
          grey_sums(rows(cv::Range(top - first, bottom - first), cv::Range(left, right)));
    }
  }
  rows_ = end;
}

GreySums RegionSums::all() const noexcept {
  GreySums out;
  for (const GreySums& tile : tiles_) out += tile;
  return out;
}

std::array<GreySums, kTiles> tile_sums(const cv::Mat& region) {
  RegionSums sums(region.cols, region.rows);
  sums.add_rows(region);
  return sums.tiles();
}

}  // namespace telekerf::imaging
