// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "common/streaming/playout_clock.h"

namespace telekerf::streaming {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// A stream of blocks of 16 samples at 1 kHz over a link with the given delay; returns the number of control
/// steps at which the sample to apply had not arrived yet, after a warm-up of 3 s.
struct LinkRun {
  int missing = 0;
  double lag_early = 0.0;  // ms from making a sample to applying it, after the warm-up
  double lag_late = 0.0;   // and at the end
  PlayoutClock clock{PlayoutSettings{}};

  template <class Delay>
  void run(int blocks, Delay delay_ns, double drift = 0.0) {
    std::vector<std::pair<std::int64_t, std::int64_t>> arrivals;  // time, last sample
    for (int b = 0; b < blocks; ++b) {
      const std::int64_t last = 16 * b + 15;
      const auto made_ns = static_cast<std::int64_t>(static_cast<double>(last * kMs) * (1.0 + drift));
      arrivals.emplace_back(made_ns + delay_ns(b), last);
    }
    std::sort(arrivals.begin(), arrivals.end());
    std::size_t next = 0;
    std::int64_t newest = -1;
    bool underrun = false;
    for (std::int64_t now = 0; next < arrivals.size(); now += kMs) {
      while (next < arrivals.size() && arrivals[next].first <= now) {
        newest = std::max(newest, arrivals[next].second);
        clock.arrived(arrivals[next].first, arrivals[next].second, 16, kMs, false);
        ++next;
      }
      const auto cursor = clock.advance(now, kMs, underrun);
      if (!cursor) continue;
      underrun = *cursor > static_cast<double>(newest);
      if (now > 3000 * kMs && underrun) ++missing;
      const double lag = static_cast<double>(now) / kMs - *cursor;
      if (now == 3000 * kMs) lag_early = lag;
      lag_late = lag;
    }
  }
};

TEST(PlayoutClock, ConstantDelayCostsBlockLookaheadAndMarginOnly) {
  LinkRun link;
  link.run(1000, [](int) { return 50 * kMs; });
  EXPECT_EQ(link.missing, 0);
  EXPECT_EQ(link.clock.corrections(), 0u);
  EXPECT_NEAR(link.lag_late, 50 + 15 + 4 + 2, 1.0);
}

TEST(PlayoutClock, JitterIsCoveredAndTheDelayStaysConstant) {
  std::mt19937 random(7);
  std::normal_distribution<double> jitter(0.0, 5.0);
  LinkRun link;
  link.run(3000,
           [&](int) { return 50 * kMs + static_cast<std::int64_t>(std::max(-40.0, jitter(random)) * kMs); });
  EXPECT_LT(link.missing, 48000 / 100);  // at most the share that the quantile leaves, in block lengths
  EXPECT_LT(link.clock.corrections(), 60u);
  EXPECT_EQ(link.clock.resyncs(), 0u);
}

TEST(PlayoutClock, ADelayStepIsFollowedWithoutResyncing) {
  LinkRun link;
  link.run(2000, [](int b) { return (b < 1000 ? 50 : 100) * kMs; });
  EXPECT_EQ(link.clock.resyncs(), 0u);
  EXPECT_NEAR(link.lag_late - link.lag_early, 50.0, 3.0);
  EXPECT_LT(link.missing, 150);
}

TEST(PlayoutClock, ClockDriftIsCorrectedByWholeTicks) {
  LinkRun link;
  link.run(
      4000, [](int) { return 20 * kMs; }, 100e-6);  // the master's clock is 100 ppm slow
  EXPECT_EQ(link.missing, 0);
  EXPECT_EQ(link.clock.resyncs(), 0u);
  EXPECT_NEAR(static_cast<double>(link.clock.corrections()), 64000 * 100e-6, 6.0);
}

}  // namespace
}  // namespace telekerf::streaming
