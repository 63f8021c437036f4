// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "common/streaming/link_statistics.h"

namespace telekerf::streaming {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(LinkStatistics, TheTimeThatTheSlaveHoldsIsNoNetworkTime) {
  LinkStatistics meter;
  for (std::uint32_t n = 1; n <= 100; ++n) {
    StateHeader state;
    state.sequence = n;
    state.echo_sequence = n;
    state.echo_sent_ns = 16 * kMs * n;
    state.echo_received_ns = 777 * kMs + 16 * kMs * n;  // another clock
    state.sent_ns = state.echo_received_ns + 9 * kMs;   // held for 9 ms
    meter.received(state, state.echo_sent_ns + 9 * kMs + (n <= 90 ? 40 : 80) * kMs);
  }
  EXPECT_NEAR(meter.rtt_quantile_ms(0.5), 40.0, 0.05);
  EXPECT_NEAR(meter.rtt_quantile_ms(0.95), 80.0, 0.05);
}

TEST(LinkStatistics, IgnoresRepeatedEchoes) {
  LinkStatistics meter;
  StateHeader state;
  for (const std::uint32_t n : {1U, 2U, 5U, 4U, 6U}) {
    state.sequence = n;
    state.echo_sequence = 1;
    meter.received(state, 10 * kMs * n);
  }
  EXPECT_NEAR(meter.rtt_quantile_ms(0.99), 10.0, 0.05) << "only the first echo of a command is a round trip";
}

}  // namespace
}  // namespace telekerf::streaming
