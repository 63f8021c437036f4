// SPDX-License-Identifier: Apache-2.0
// What comes to a play-out clock.
#pragma once

#include <cstdint>
#include <initializer_list>

#include "common/streaming/playout_clock.h"
#include "tests/unit/streaming/blocks.h"

namespace telekerf::streaming {

/// 16 samples at 1 kHz.
inline BlockArrival block(std::int64_t now_ns, std::int64_t last, bool lost = false) {
  return {.now_ns = now_ns,
          .sent_ns = last * kMs,
          .last = last,
          .count = 16,
          .sample_period_ns = kMs,
          .copies = 1,
          .lost = lost};
}

/// Blocks of 16 samples at 1 kHz that were under way for so many ms.
inline void arrive(PlayoutClock& clock, std::initializer_list<double> transits_ms, bool lost = false,
                   bool placed = true) {
  std::int64_t last = 15;
  for (const double transit_ms : transits_ms) {
    BlockArrival arrival = block(last * kMs + static_cast<std::int64_t>(transit_ms * kMs), last, lost);
    arrival.placed = placed;
    clock.arrived(arrival);
    last += 16;
  }
}

}  // namespace telekerf::streaming
