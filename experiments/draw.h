// SPDX-License-Identifier: Apache-2.0
// Random numbers of a seed, the same with every library.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <random>

namespace telekerf::experiments {

/// Not the standard's distributions: their sequences are not the same in every library.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  double between(double least, double most) {
    return least + (most - least) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  /// As likely to be halved as to be doubled.
  double factor(double least, double most) { return std::exp(between(std::log(least), std::log(most))); }
  template <typename Values>
  auto one_of(const Values& values) {
    return *std::next(std::begin(values), static_cast<std::ptrdiff_t>(random_() % std::size(values)));
  }
  bool one_in(unsigned n) { return random_() % n == 0; }
  std::uint64_t word() { return random_(); }

 private:
  std::mt19937_64 random_;
};

}  // namespace telekerf::experiments
