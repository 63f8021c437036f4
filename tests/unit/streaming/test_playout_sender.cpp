// SPDX-License-Identifier: Apache-2.0
// Stamps of a sender that are not to be believed.
#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/streaming/playout_blocks.h"

namespace telekerf::streaming {
namespace {

/// What no clock says, one that is set, and one that won time count as nothing: the delay of the link is what
/// it was.
TEST(PlayoutClock, ASendersClockThatCannotBeTrueIsNotBelieved) {
  constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();
  for (const std::int64_t wrong : {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}, kLargest,
                                   std::int64_t{1} << 62, 16'000 * kMs, 12'000 * kMs, 60 * kMs}) {
    PlayoutClock clock{PlayoutSettings{}};
    arrive(clock, {5.0, 5.0, 5.0});
    BlockArrival arrival = block(63 * kMs + 5 * kMs, 63);
    arrival.sent_ns = wrong;
    clock.arrived(arrival);
    EXPECT_EQ(clock.depth_samples(), 17) << wrong;
    EXPECT_EQ(clock.advance(1000 * kMs, kMs), 1000.0 - 5.0 - 17.0) << wrong;
  }
  for (const std::int64_t wrong : {std::numeric_limits<std::int64_t>::min(), kLargest}) {
    PlayoutClock clock{PlayoutSettings{}};
    BlockArrival arrival = block(20 * kMs, 15);
    arrival.sent_ns = wrong;
    clock.arrived(arrival);
    EXPECT_EQ(clock.advance(1000 * kMs, kMs), 1000.0 - 5.0 - 17.0) << wrong;
  }
}

TEST(PlayoutClock, NorIsOneThatStandsStill) {
  PlayoutClock clock{PlayoutSettings{}};
  for (std::int64_t n = 0; n < 200; ++n) {
    BlockArrival arrival = block((16 * n + 15 + (n == 3 ? 13 : 5)) * kMs, 16 * n + 15);
    arrival.sent_ns = 7 * kMs;
    clock.arrived(arrival);
  }
  EXPECT_EQ(clock.depth_samples(), 17);
  EXPECT_EQ(clock.advance(4000 * kMs, kMs), 4000.0 - 5.0 - 17.0);
}

}  // namespace
}  // namespace telekerf::streaming
