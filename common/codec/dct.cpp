// SPDX-License-Identifier: Apache-2.0
#include "common/codec/dct.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace telekerf::codec {
namespace {

/// Outputs that are summed at a time: twice eight sums fit the registers of the smallest vector unit.
constexpr std::size_t kChunk = 8;
/// From this half length on, one more fold pays.
constexpr std::size_t kSplit = 16;

/// cos(pi t / 2N) by its series, t reduced to at most an eighth of a turn first. Only additions and products,
/// which every machine rounds alike; a library's cosine may differ in the last bit, and then both ends would
/// not decode the same.
double cosine(int t, int size) {
  t %= 4 * size;
  if (t > 2 * size) t = 4 * size - t;
  if (t > size) return -cosine(2 * size - t, size);
  const bool as_sine = 2 * t > size;
  const double angle = (as_sine ? size - t : t) * std::numbers::pi / (2.0 * size);
  double term = as_sine ? angle : 1.0;
  double sum = 0.0;
  for (int order = as_sine ? 1 : 0; order < 24; order += 2) {
    sum += term;
    term *= -angle * angle / ((order + 1) * (order + 2));
  }
  return sum;
}

}  // namespace

Dct::Dct(int size)
    : size_(size),
      half_((size + 1) / 2),
      stride_((half_ + static_cast<int>(kChunk) - 1) / static_cast<int>(kChunk) * static_cast<int>(kChunk)) {
  const auto half = static_cast<std::size_t>(half_);
  const auto stride = static_cast<std::size_t>(stride_);
  even_.resize(half * stride);
  odd_.resize(half * stride);
  even_by_row_.resize(half * half);
  odd_by_row_.resize(half * half);
  const auto entry = [&](int k, int n) {
    if (k >= size) return 0.0;
    const double scale = k == 0 ? std::sqrt(1.0 / size) : std::sqrt(2.0 / size);
    return scale * cosine((2 * n + 1) * k, size);
  };
  for (int n = 0; n < half_; ++n) {
    // The middle sample of an odd block stands once, not twice, in the folded sums.
    for (int j = 0; j < half_; ++j) {
      const double even = entry(2 * j, n);
      const double odd = 2 * n + 1 == size ? 0.0 : entry(2 * j + 1, n);
      const auto sample = static_cast<std::size_t>(n);
      const auto row = static_cast<std::size_t>(j);
      even_[sample * stride + row] = even;
      odd_[sample * stride + row] = odd;
      even_by_row_[row * half + sample] = even;
      odd_by_row_[row * half + sample] = odd;
    }
  }
}

const Dct& Dct::of_size(int size) noexcept {
  static const std::vector<Dct> tables = [] {
    std::vector<Dct> all;
    for (int n = kMinTransform; n <= kMaxBlock; ++n) all.push_back(Dct(n));
    return all;
  }();
  return tables[static_cast<std::size_t>(size - kMinTransform)];
}

void Dct::forward(std::span<const double> x, std::span<double> c) const noexcept {
  std::array<double, kMaxBlock / 2> sums;
  std::array<double, kMaxBlock / 2> differences;
  const auto half = static_cast<std::size_t>(half_);
  const auto size = static_cast<std::size_t>(size_);
  const auto stride = static_cast<std::size_t>(stride_);
  for (std::size_t n = 0; n < half; ++n) {
    const std::size_t mirror = size - 1 - n;
    sums[n] = n == mirror ? x[n] : x[n] + x[mirror];
    differences[n] = x[n] - x[mirror];
  }
  if (size % 2 == 0 && half >= kSplit) {
    // The even coefficients are the transform of the folded sums, at half the length.
    std::array<double, kMaxBlock / 2> evens;
    of_size(half_).forward(std::span(sums).first(half), std::span(evens).first(half));
    for (std::size_t j = 0; j < half; ++j) c[2 * j] = evens[j] / std::numbers::sqrt2;
    for (std::size_t first = 0; first < half; first += kChunk) {
      std::array<double, kChunk> odd{};
      for (std::size_t n = 0; n < half; ++n) {
        const double* row = &odd_[n * stride + first];
        for (std::size_t j = 0; j < kChunk; ++j) odd[j] += differences[n] * row[j];
      }
      for (std::size_t j = 0; j < std::min(kChunk, half - first); ++j) c[2 * (first + j) + 1] = odd[j];
    }
    return;
  }
  for (std::size_t first = 0; first < half; first += kChunk) {
    std::array<double, kChunk> even{};
    std::array<double, kChunk> odd{};
    for (std::size_t n = 0; n < half; ++n) {
      const double* even_row = &even_[n * stride + first];
      const double* odd_row = &odd_[n * stride + first];
      for (std::size_t j = 0; j < kChunk; ++j) {
        even[j] += sums[n] * even_row[j];
        odd[j] += differences[n] * odd_row[j];
      }
    }
    const std::size_t count = std::min(kChunk, half - first);
    for (std::size_t j = 0; j < count; ++j) {
      const std::size_t k = 2 * (first + j);
      c[k] = even[j];
      if (k + 1 < size) c[k + 1] = odd[j];
    }
  }
}

void Dct::inverse(std::span<const double> c, std::span<double> x) const noexcept {
  constexpr std::size_t kHalf = kMaxBlock / 2;
  std::array<double, kHalf> even{};
  std::array<double, kHalf> odd{};
  const auto half = static_cast<std::size_t>(half_);
  const auto size = static_cast<std::size_t>(size_);
  for (std::size_t k = 0; k < size; ++k) {
    if (c[k] == 0.0) continue;
    const auto& table = k % 2 == 0 ? even_by_row_ : odd_by_row_;
    const double* row = &table[(k / 2) * half];
    auto& sums = k % 2 == 0 ? even : odd;
    for (std::size_t n = 0; n < half; ++n) sums[n] += c[k] * row[n];
  }
  for (std::size_t n = 0; n < half; ++n) {
    x[n] = even[n] + odd[n];
    x[size - 1 - n] = even[n] - odd[n];
  }
}

}  // namespace telekerf::codec
