// SPDX-License-Identifier: Apache-2.0
// What a report says of many errors: their root mean square and the largest.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace telekerf {

struct ErrorStatistics {
  double squares = 0.0;
  double max = 0.0;  ///< magnitude
  std::size_t count = 0;

  void add(double error) {
    squares += error * error;
    max = std::max(max, std::abs(error));
    ++count;
  }
  void add(const ErrorStatistics& others) {
    squares += others.squares;
    max = std::max(max, others.max);
    count += others.count;
  }
  /// 0 of none.
  double rms() const { return count == 0 ? 0.0 : std::sqrt(squares / static_cast<double>(count)); }
};

}  // namespace telekerf
