// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <utility>

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

/// A round trip of so many ms, one a second.
void trip(LinkStatistics& meter, std::uint32_t number, double rtt_ms) {
  StateHeader state;
  state.echo_sequence = number;
  state.echo_sent_ns = std::int64_t{number} * 1000 * kMs;
  state.echo_received_ns = state.echo_sent_ns + static_cast<std::int64_t>(0.5e6 * rtt_ms);
  state.sent_ns = state.echo_received_ns;
  meter.received(state, state.echo_sent_ns + static_cast<std::int64_t>(1e6 * rtt_ms));
}

TEST(LinkStatistics, AQuantileIsTheMiddleOfTheBinOfItsRank) {
  LinkStatistics meter;
  EXPECT_EQ(meter.rtt_quantile_ms(0.5), 0.0) << "nothing is known";
  for (std::uint32_t n = 1; n <= 10; ++n) trip(meter, n, n + 0.011);
  EXPECT_EQ(meter.round_trips(), 10u);
  for (const auto& [fraction, rank] :
       {std::pair{0.05, 1}, {0.1, 1}, {0.11, 2}, {0.5, 5}, {0.51, 6}, {1.0, 10}}) {
    EXPECT_NEAR(meter.rtt_quantile_ms(fraction), rank + 0.01, 1e-9) << fraction;
  }
  EXPECT_NEAR(meter.rtt_quantile_ms(1.1), 2999.99, 1e-9) << "more than all: the end of the scale";
}

TEST(LinkStatistics, WhatIsLongerThanThreeSecondsIsAtTheEnd) {
  LinkStatistics meter;
  trip(meter, 1, -5.0);  // the stamps of two looks at the clock
  EXPECT_NEAR(meter.rtt_quantile_ms(1.0), 0.01, 1e-9);
  trip(meter, 2, 9000.0);
  EXPECT_NEAR(meter.rtt_quantile_ms(1.0), 2999.99, 1e-9);
  trip(meter, 0, 100.0);
  EXPECT_EQ(meter.round_trips(), 2u) << "number 0: the slave has heard nothing";
  EXPECT_EQ(meter.clocks_wrong(), 0u);
}

TEST(LinkStatistics, AnAnswerBeforeItsQuestionIsAWrongClockAndNoRoundTrip) {
  LinkStatistics meter;
  StateHeader state;
  state.echo_sequence = 1;
  state.echo_sent_ns = 1000 * kMs;
  state.echo_received_ns = state.sent_ns = 500 * kMs;
  EXPECT_FALSE(meter.received(state, 989 * kMs)) << "before it was sent";
  state.echo_sequence = 2;
  state.sent_ns = 489 * kMs;
  EXPECT_FALSE(meter.received(state, 1100 * kMs)) << "held for less than no time";
  state.echo_sequence = 3;
  state.sent_ns = 800 * kMs;
  EXPECT_FALSE(meter.received(state, 1289 * kMs)) << "held for longer than the whole way";
  EXPECT_EQ(meter.clocks_wrong(), 3u);
  EXPECT_EQ(meter.round_trips(), 0u);
  EXPECT_EQ(meter.rtt_quantile_ms(0.5), 0.0);
  EXPECT_TRUE(meter.received(state, 1400 * kMs)) << "said already";
  state.echo_sequence = 4;
  EXPECT_TRUE(meter.received(state, 1291 * kMs));
  EXPECT_EQ(meter.round_trips(), 1u);
}

TEST(LinkStatistics, PacketsAreCountedAndClocksComparedAsOfTheNewestState) {
  LinkStatistics meter;
  CommandBlock block;
  block.payload.size = 70;
  for (int n = 0; n < 3; ++n) meter.sent(block, n);
  EXPECT_EQ(meter.packets(), 3u);
  EXPECT_EQ(meter.payload_bytes(), 210u);
  EXPECT_EQ(meter.mean_copies(), 1.0);
  EXPECT_EQ(meter.max_copies(), 2);
  for (std::uint32_t n = 1; n <= 10; ++n) {
    StateHeader state;
    state.echo_sequence = n;
    state.echo_sent_ns = std::int64_t{n} * 1000 * kMs;
    const std::int64_t offset_ns = 5 * kMs + std::int64_t{n} * 100'000;  // 100 ppm
    state.echo_received_ns = state.echo_sent_ns + 10 * kMs + offset_ns;
    state.sent_ns = state.echo_received_ns + 3 * kMs;
    meter.received(state, state.echo_sent_ns + 23 * kMs);
  }
  EXPECT_NEAR(meter.clocks().skew, 100e-6, 1e-9);
  EXPECT_NEAR(meter.clocks().offset_s, 6e-3 + 100e-6 * 0.0115, 1e-9) << "when the last one came";
}

}  // namespace
}  // namespace telekerf::streaming
