// SPDX-License-Identifier: Apache-2.0
#include "common/codec/selection.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

namespace telekerf::codec {
namespace {

constexpr int kMax = 64;
using Triangle = std::array<std::array<std::uint64_t, kMax + 1>, kMax + 1>;

constexpr Triangle pascal() {
  Triangle triangle{};
  for (std::size_t n = 0; n <= kMax; ++n) {
    triangle[n][0] = 1;
    for (std::size_t k = 1; k <= n; ++k) {
      triangle[n][k] = triangle[n - 1][k - 1] + (k < n ? triangle[n - 1][k] : 0);
    }
  }
  return triangle;
}
constexpr Triangle kPascal = pascal();

/// Up to here keeping a sorted short list beats partitioning: energy sits at the low indices, few entries
/// ever move.
constexpr int kFew = 12;

IndexSet strongest_few(std::span<const double> coefficients, int m) noexcept {
  std::array<double, kFew + 1> magnitude;
  std::array<std::uint8_t, kFew + 1> index;
  int count = 0;
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    const double value = std::abs(coefficients[k]);
    if (count == m && !(value > magnitude[static_cast<std::size_t>(m - 1)])) continue;
    auto at = static_cast<std::size_t>(count < m ? count++ : m - 1);
    for (; at > 0 && value > magnitude[at - 1]; --at) {
      magnitude[at] = magnitude[at - 1];
      index[at] = index[at - 1];
    }
    magnitude[at] = value;
    index[at] = static_cast<std::uint8_t>(k);
  }
  IndexSet set = 0;
  for (int i = 0; i < count; ++i) set |= IndexSet{1} << index[static_cast<std::size_t>(i)];
  return set;
}

IndexSet strongest_many(std::span<const double> coefficients, int m) noexcept {
  std::array<double, kMax> magnitude;
  std::array<std::uint8_t, kMax> order;
  const auto n = coefficients.size();
  for (std::size_t k = 0; k < n; ++k) {
    magnitude[k] = std::abs(coefficients[k]);
    order[k] = static_cast<std::uint8_t>(k);
  }
  const auto stronger = [&](std::uint8_t a, std::uint8_t b) {
    return magnitude[a] != magnitude[b] ? magnitude[a] > magnitude[b] : a < b;
  };
  std::nth_element(order.begin(), order.begin() + m, order.begin() + static_cast<std::ptrdiff_t>(n),
                   stronger);
  IndexSet set = 0;
  for (int i = 0; i < m; ++i) set |= IndexSet{1} << order[static_cast<std::size_t>(i)];
  return set;
}

}  // namespace

IndexSet strongest(std::span<const double> coefficients, int m) noexcept {
  const auto n = coefficients.size();
  if (m >= static_cast<int>(n)) return n >= kMax ? ~IndexSet{0} : (IndexSet{1} << n) - 1;
  if (m <= 0) return 0;
  return m <= kFew ? strongest_few(coefficients, m) : strongest_many(coefficients, m);
}

std::uint64_t choose(int n, int k) noexcept {
  if (k < 0 || k > n) return 0;
  return kPascal[static_cast<std::size_t>(n)][static_cast<std::size_t>(k)];
}

int index_set_bits(int n, int m) noexcept { return static_cast<int>(std::bit_width(choose(n, m) - 1)); }

std::uint64_t rank_of(IndexSet set) noexcept {
  std::uint64_t rank = 0;
  int position = 1;
  for (; set != 0; set &= set - 1) rank += choose(std::countr_zero(set), position++);
  return rank;
}

IndexSet set_of_rank(std::uint64_t rank, int n, int m) noexcept {
  IndexSet set = 0;
  for (int k = n - 1; k >= 0 && m > 0; --k) {
    const auto below = choose(k, m);
    if (rank >= below) {
      rank -= below;
      set |= IndexSet{1} << k;
      --m;
    }
  }
  return set;
}

}  // namespace telekerf::codec
