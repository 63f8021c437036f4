// SPDX-License-Identifier: Apache-2.0
#include "common/codec/dct.h"

#include <array>
#include <cmath>
#include <numbers>

namespace telekerf::codec {

Dct::Dct(int size) : size_(size), half_((size + 1) / 2) {
  const auto cells = static_cast<std::size_t>(half_ * half_);
  even_.resize(cells);
  odd_.resize(cells);
  even_by_row_.resize(cells);
  odd_by_row_.resize(cells);
  const auto entry = [&](int k, int n) {
    if (k >= size) return 0.0;
    const double scale = k == 0 ? std::sqrt(1.0 / size) : std::sqrt(2.0 / size);
    // The argument is reduced in integers, so that cos() sees small angles only.
    const int turn = ((2 * n + 1) * k) % (4 * size);
    return scale * std::cos(turn * std::numbers::pi / (2.0 * size));
  };
  for (int n = 0; n < half_; ++n) {
    // The middle sample of an odd block stands once, not twice, in the folded sums.
    for (int j = 0; j < half_; ++j) {
      const double even = entry(2 * j, n);
      const double odd = 2 * n + 1 == size ? 0.0 : entry(2 * j + 1, n);
      even_[static_cast<std::size_t>(n * half_ + j)] = even;
      odd_[static_cast<std::size_t>(n * half_ + j)] = odd;
      even_by_row_[static_cast<std::size_t>(j * half_ + n)] = even;
      odd_by_row_[static_cast<std::size_t>(j * half_ + n)] = odd;
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
  constexpr std::size_t kHalf = kMaxBlock / 2;
  std::array<double, kHalf> even{};
  std::array<double, kHalf> odd{};
  const auto half = static_cast<std::size_t>(half_);
  const auto size = static_cast<std::size_t>(size_);
  for (std::size_t n = 0; n < half; ++n) {
    const std::size_t mirror = size - 1 - n;
    const double sum = n == mirror ? x[n] : x[n] + x[mirror];
    const double difference = x[n] - x[mirror];
    const double* even_row = &even_[n * half];
    const double* odd_row = &odd_[n * half];
    for (std::size_t j = 0; j < half; ++j) {
      even[j] += sum * even_row[j];
      odd[j] += difference * odd_row[j];
    }
  }
  for (std::size_t k = 0; k < size; ++k) c[k] = k % 2 == 0 ? even[k / 2] : odd[k / 2];
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
