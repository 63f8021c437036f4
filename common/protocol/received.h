// SPDX-License-Identifier: Apache-2.0
// A message with the time at which it came.
#pragma once

#include <cstdint>

namespace telekerf {

/// A message as the bus hands it over.
template <class T>
struct Received {
  T value{};
  std::int64_t received_ns = 0;  ///< CLOCK_MONOTONIC of this machine, when the middleware handed it over
};

}  // namespace telekerf
