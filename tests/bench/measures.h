// SPDX-License-Identifier: Apache-2.0
// What the benchmarks of running loops measure.
#pragma once

#include <sys/resource.h>

#include <algorithm>
#include <vector>

namespace telekerf::bench {

/// Of this process so far, all threads, s.
inline double processor_s() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

/// The nearest value below; -1: there is none.
inline double quantile(std::vector<double> values, double fraction) {
  if (values.empty()) return -1.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1))];
}

}  // namespace telekerf::bench
