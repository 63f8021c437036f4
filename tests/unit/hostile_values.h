// SPDX-License-Identifier: Apache-2.0
// Values that no honest sender puts into a message.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <random>

namespace telekerf {

/// Repeatable by its seed.
class HostileValues {
 public:
  static constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  static constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();

  explicit HostileValues(std::uint64_t seed) : random_(seed) {}
  std::uint64_t operator()() { return random_(); }
  bool one_in(std::uint64_t n) { return random_() % n == 0; }
  /// Any of these, or anything.
  template <class T>
  T some(std::initializer_list<T> values) {
    const std::size_t n = random_() % (values.size() + 1);
    return n < values.size() ? values.begin()[n] : static_cast<T>(random_());
  }
  double some_number() {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    constexpr double kNumbers[] = {0.0,
                                   -0.0,
                                   1e-300,
                                   1e-3,
                                   -1.0,
                                   1.0,
                                   1e9,
                                   -1e300,
                                   kInfinite,
                                   -kInfinite,
                                   std::numeric_limits<double>::quiet_NaN()};
    return kNumbers[random_() % std::size(kNumbers)];
  }

 private:
  std::mt19937_64 random_;
};

}  // namespace telekerf
