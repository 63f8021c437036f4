// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "tests/unit/streaming/playout_blocks.h"

namespace telekerf::streaming {
namespace {

/// A stream of blocks of 16 samples at 1 kHz over a link with the given delay; returns the number of control
/// steps at which the sample to apply had not arrived yet, after a warm-up of 3 s.
struct LinkRun {
  int missing = 0;
  double lag_early = 0.0;  // ms from making a sample to applying it, after the warm-up
  double lag_late = 0.0;   // and at the end
  double slowest = 1.0;    // samples a step, of all steps
  double fastest = 1.0;
  double before = 0.0;
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
    for (std::int64_t now = 0; next < arrivals.size(); now += kMs) {
      while (next < arrivals.size() && arrivals[next].first <= now) {
        newest = std::max(newest, arrivals[next].second);
        clock.arrived(block(arrivals[next].first, arrivals[next].second));
        ++next;
      }
      const auto cursor = clock.advance(now, kMs);
      if (!cursor) continue;
      if (now > 3000 * kMs && *cursor > static_cast<double>(newest)) ++missing;
      if (now > 0 && clock.went_on()) {
        slowest = std::min(slowest, *cursor - before);
        fastest = std::max(fastest, *cursor - before);
      }
      before = *cursor;
      const double lag = static_cast<double>(now) / kMs - *cursor;
      if (now == 3000 * kMs) lag_early = lag;
      lag_late = lag;
    }
  }
};

TEST(PlayoutClock, ConstantDelayCostsBlockAndMarginOnly) {
  LinkRun link;
  link.run(1000, [](int) { return 50 * kMs; });
  EXPECT_EQ(link.missing, 0);
  EXPECT_EQ(link.clock.corrections(), 0u);
  EXPECT_NEAR(link.lag_late, 50 + 15 + 2, 0.5);
  EXPECT_EQ(link.clock.depth_samples(), 15 + 2);
  EXPECT_NEAR(link.clock.wait_s(), 2e-3, 1e-12) << "what is not block filling";
}

TEST(PlayoutClock, JitterIsCoveredAndTheDelayStaysConstant) {
  std::mt19937 random(7);
  std::normal_distribution<double> jitter(0.0, 5.0);
  LinkRun link;
  link.run(3000,
           [&](int) { return 50 * kMs + static_cast<std::int64_t>(std::max(-40.0, jitter(random)) * kMs); });
  EXPECT_LE(link.missing, 5);
  EXPECT_NEAR(static_cast<double>(link.clock.corrections()), 16.0, 3.0);
  EXPECT_EQ(link.clock.resyncs(), 0u);
}

TEST(PlayoutClock, ADelayStepIsFollowedWithoutResyncing) {
  LinkRun link;
  link.run(2000, [](int b) { return (b < 1000 ? 50 : 100) * kMs; });
  EXPECT_EQ(link.clock.resyncs(), 0u);
  EXPECT_NEAR(link.lag_early, 67.0, 0.5);
  EXPECT_NEAR(link.lag_late, 117.0, 0.5);
  EXPECT_NEAR(link.slowest, 0.8, 1e-9) << "a fifth slower, until the delay is there";
  EXPECT_NEAR(link.missing, 308, 3);
}

TEST(PlayoutClock, ClockDriftIsCorrectedByWholeTicks) {
  LinkRun link;
  link.run(
      4000, [](int) { return 20 * kMs; }, 100e-6);  // the master's clock is 100 ppm slow
  EXPECT_EQ(link.missing, 0);
  EXPECT_EQ(link.clock.resyncs(), 0u);
  EXPECT_NEAR(static_cast<double>(link.clock.corrections()), 64000 * 100e-6 - 1.5, 1.0);
  EXPECT_NEAR(link.slowest, 0.955, 1e-3) << "a single sample does not take the whole fifth";
  EXPECT_EQ(link.fastest, 1.0);
}

/// The history of 8 s is forgotten first, then a sample is given back in 0.2 s, but for the last three.
TEST(PlayoutClock, TheLagFallsWhenTheDelayFalls) {
  LinkRun link;
  link.run(3000, [](int b) { return (b < 1000 ? 100 : 50) * kMs; });
  EXPECT_EQ(link.clock.resyncs(), 0u);
  EXPECT_NEAR(link.lag_early, 117.0, 0.5);
  EXPECT_NEAR(link.lag_late, 70.0, 0.5);
  EXPECT_NEAR(link.fastest, 1.005, 1e-9);
  EXPECT_EQ(link.clock.corrections(), 47u);
  EXPECT_EQ(link.missing, 0);
}

/// A network that was a second late for a while: what it queued is no jitter to be waited for.
TEST(PlayoutClock, ADelayThatHasGoneIsForgottenWithinThreeSeconds) {
  LinkRun link;
  link.run(500, [](int b) { return (b < 200 || b > 280 ? 50 : 1250) * kMs; });
  EXPECT_NEAR(link.lag_late, link.lag_early, 5.0);
  LinkRun soon;
  soon.run(281 + 190, [](int b) { return (b < 200 || b > 280 ? 50 : 1250) * kMs; });
  EXPECT_NEAR(soon.lag_late, soon.lag_early, 5.0) << "3 s after its end, 1.8 s after the last late block";
}

/// Where commands are too old to be of use, a delay that has gone is given back at once, however small it
/// was.
TEST(PlayoutClock, InAHurryADelayThatHasGoneIsGivenBackWithinThreeSeconds) {
  const auto late = [](int b) { return (b < 200 || b > 280 ? 50 : 200) * kMs; };
  LinkRun calm;
  calm.run(281 + 190, late);
  EXPECT_GT(calm.lag_late, calm.lag_early + 100.0) << "it is kept for what may come again";
  LinkRun hurried;
  hurried.clock.hurry(true);
  hurried.run(281 + 190, late);
  EXPECT_NEAR(hurried.lag_late, hurried.lag_early, 5.0);
  EXPECT_LT(hurried.fastest, 1.201);
  hurried.clock.hurry(false);
}

TEST(PlayoutClock, TheDepthIsBlockFillingMarginAndTheQuantileOfTheJitter) {
  for (const int blocks : {1, 2, 100, 200, 512, 700}) {
    PlayoutClock clock{PlayoutSettings{.max_depth_s = 10.0}};
    for (int b = 0; b < blocks; ++b) {
      const std::int64_t last = 16 * b + 15;
      clock.arrived(block((last + b) * kMs, last));  // later and later by a millisecond
    }
    const int held = std::min(blocks, 512);
    const int spread_ms = static_cast<int>(std::lround(0.995 * (held - 1)));
    EXPECT_EQ(clock.depth_samples(), spread_ms + 15 + 2) << blocks;
  }
}

TEST(PlayoutClock, FractionsOfASampleAreRoundedUpAndTheDepthIsLimited) {
  PlayoutClock clock{PlayoutSettings{}};
  arrive(clock, {3.0, 3.1});
  EXPECT_EQ(clock.depth_samples(), 18);
  arrive(clock, {3.0, 5000.0});
  EXPECT_EQ(clock.depth_samples(), 2000);
  PlayoutClock sized{PlayoutSettings{.margin_s = 0.01}};
  sized.arrived({.last = 7, .count = 8, .sample_period_ns = 2 * kMs, .lookahead = 7});
  EXPECT_EQ(sized.depth_samples(), 7 + 7 + 5);
  EXPECT_NEAR(sized.wait_s(), 24e-3, 1e-12);
}

TEST(PlayoutClock, ALossDeepensItByTheCopiesThatThePacketsCarryForTenSeconds) {
  PlayoutClock clock{PlayoutSettings{}};
  int copies = 2;
  const auto depth = [&](std::int64_t second, bool lost) {
    BlockArrival arrival = block(second * 1000 * kMs, second * 1000, lost);
    arrival.copies = copies;
    clock.arrived(arrival);
    return clock.depth_samples();
  };
  EXPECT_EQ(depth(1, false), 17);
  EXPECT_EQ(depth(2, true), 17 + 32);
  for (std::int64_t second = 3; second < 12; ++second) EXPECT_EQ(depth(second, false), 17 + 32) << second;
  EXPECT_EQ(depth(12, false), 17);
  EXPECT_EQ(depth(13, true), 17 + 32);
  EXPECT_EQ(depth(22, true), 17 + 32);
  copies = 7;
  EXPECT_EQ(depth(23, false), 17 + 112);
  copies = 0;
  EXPECT_EQ(depth(24, false), 17) << "nothing to wait for";
  copies = 2;
  EXPECT_EQ(depth(31, false), 17 + 32) << "each loss counts anew";
  EXPECT_EQ(depth(32, false), 17);
}

/// A link that is 5 ms slow: at 1000 ms the cursor is 1000 - 5 - 17.
class Corrected : public testing::Test {
 protected:
  Corrected() { arrive(clock_, {5.0}); }
  /// Negative: not yet.
  double advance(double now_ms, double step_ms) {
    return clock_.advance(std::llround(now_ms * 1e6), std::llround(step_ms * 1e6)).value_or(-1.0);
  }
  double begin() { return advance(1000.0, 1.0); }
  PlayoutClock clock_{PlayoutSettings{}};
};

TEST_F(Corrected, BeginsAtAWholeSampleAndGoesOnByTheControlPeriod) {
  EXPECT_DOUBLE_EQ(advance(1000.6, 1.0), 978.0);
  EXPECT_FALSE(clock_.went_on());
  EXPECT_DOUBLE_EQ(advance(1001.6, 1.0), 979.0);
  EXPECT_TRUE(clock_.went_on());
  EXPECT_DOUBLE_EQ(advance(1002.1, 0.5), 979.5);
  EXPECT_EQ(clock_.corrections(), 0u);
  EXPECT_EQ(clock_.resyncs(), 0u);
  PlayoutClock silent{PlayoutSettings{}};
  EXPECT_FALSE(silent.advance(0, kMs)) << "nothing has come";
  EXPECT_FALSE(silent.went_on());
}

TEST_F(Corrected, WhatIsTooEarlyGoesBySlowerUntilTheWholeSamplesAreGiven) {
  EXPECT_DOUBLE_EQ(begin(), 978.0);
  EXPECT_DOUBLE_EQ(advance(1001.0, 2.5), 980.5) << "one and a half too far is borne, to the very bit";
  EXPECT_EQ(clock_.corrections(), 0u);
  double played = advance(1001.0, 30.25);
  double pace = 1.0;
  double slowest = 1.0;
  for (int n = 0; n < 400; ++n) {
    const double next = advance(1002.0 + n, 1.0);
    EXPECT_TRUE(clock_.went_on());
    pace = next - played;
    slowest = std::min(slowest, pace);
    played = next;
  }
  EXPECT_EQ(clock_.corrections(), 31u) << "whole samples";
  EXPECT_NEAR(slowest, 0.8, 1e-9);
  EXPECT_DOUBLE_EQ(pace, 1.0);
  EXPECT_DOUBLE_EQ(played, 1001.0 + 400.0 - 5.0 - 17.0 + 0.75) << "less than a sample too early";
}

TEST_F(Corrected, ThePaceChangesWithinTwentyMilliseconds) {
  EXPECT_DOUBLE_EQ(begin(), 978.0);
  arrive(clock_, {205.0, 205.0, 205.0});
  double played = 978.0;
  double pace = 1.0;
  double largest = 0.0;
  for (int n = 1; n < 2000; ++n) {
    const double next = advance(1000.0 + n, 1.0);
    largest = std::max(largest, std::abs(next - played - pace));
    pace = next - played;
    played = next;
  }
  EXPECT_LE(largest, 0.01 + 1e-9) << "a fifth of the pace in twenty steps";
  EXPECT_GE(clock_.corrections(), 199u);
}

TEST_F(Corrected, WhatIsTooLateGoesByATwoHundredthFasterAndTheLastThreeAreKept) {
  EXPECT_DOUBLE_EQ(begin(), 978.0);
  EXPECT_DOUBLE_EQ(advance(1004.5, 1.0), 979.0) << "three and a half behind are borne";
  EXPECT_EQ(clock_.corrections(), 0u);
  double played = 979.0;
  double fastest = 0.0;
  for (int n = 0; n < 1000; ++n) {
    const double next = advance(1007.75 + n, 1.0);
    fastest = std::max(fastest, next - played);
    played = next;
  }
  EXPECT_EQ(clock_.corrections(), 3u);
  EXPECT_NEAR(fastest, 1.005, 1e-9);
  EXPECT_DOUBLE_EQ(played, 979.0 + 1000.0 + 3.0);
}

TEST_F(Corrected, BareAccelerationsBeginAnewBeyondAQuarterOfASecond) {
  constexpr bool kPlaced = false;
  clock_.reset();
  arrive(clock_, {5.0}, false, kPlaced);
  EXPECT_DOUBLE_EQ(begin(), 978.0);
  EXPECT_DOUBLE_EQ(advance(1250.0, 0.0), 978.0) << "250 behind: as ever";
  EXPECT_EQ(clock_.resyncs(), 0u);
  clock_.reset();
  arrive(clock_, {5.0}, false, kPlaced);
  EXPECT_DOUBLE_EQ(begin(), 978.0);
  EXPECT_DOUBLE_EQ(advance(1250.1, 0.0), 1228.0) << "and 250.1 behind it has given up";
  EXPECT_EQ(clock_.resyncs(), 1u);
  EXPECT_EQ(clock_.corrections(), 247u);
  EXPECT_FALSE(clock_.went_on());
  EXPECT_LT(advance(1000.0, 1.0), 1229.0) << "250 too far";
  EXPECT_EQ(clock_.resyncs(), 1u);
  clock_.reset();
  arrive(clock_, {5.0}, false, kPlaced);
  EXPECT_DOUBLE_EQ(advance(1250.1, 0.0), 1228.0);
  EXPECT_DOUBLE_EQ(advance(999.0, 1.0), 977.0);
  EXPECT_EQ(clock_.resyncs(), 2u);
}

TEST_F(Corrected, PlacesThatAreFurtherBehindAreCaughtUpWithInAHurry) {
  EXPECT_DOUBLE_EQ(begin(), 978.0);
  double played = advance(1251.0, 1.0);
  double fastest = 0.0;
  int steps = 0;
  for (; played < 1251.0 + steps - 26.0 && steps < 3000; ++steps) {
    const double next = advance(1252.0 + steps, 1.0);
    ASSERT_GE(next, played);
    fastest = std::max(fastest, next - played);
    played = next;
  }
  EXPECT_NEAR(fastest, 1.2, 1e-9);
  EXPECT_NEAR(steps, 1250, 30) << "250 by a fifth";
  EXPECT_EQ(clock_.resyncs(), 0u);
  (void)advance(1252.0 + steps + 752.0, 1.0);
  EXPECT_EQ(clock_.resyncs(), 1u) << "more than 750 behind";
}

TEST_F(Corrected, WhatStoodSetsOffWithinFiftyMillisecondsAndCatchesUpInAHurry) {
  EXPECT_DOUBLE_EQ(begin(), 978.0);
  for (int n = 1; n <= 200; ++n) {
    (void)advance(1000.0 + n, 1.0);
    EXPECT_DOUBLE_EQ(clock_.stand(979.0), std::min(979.0, 978.0 + n));
  }
  double played = 979.0;
  double pace = 0.0;
  double fastest = 0.0;
  for (int n = 1; n <= 3000; ++n) {
    const double next = advance(1200.0 + n, 1.0);
    EXPECT_NEAR(next - played, pace, n < 42 ? 0.02 + 1e-9 : 0.01 + 1e-9) << n;
    EXPECT_TRUE(clock_.went_on());
    pace = next - played;
    fastest = std::max(fastest, pace);
    played = next;
    if (n == 60) {
      EXPECT_GE(pace, 1.0) << "it has set off";
    }
  }
  EXPECT_NEAR(fastest, 1.2, 1e-9);
  const double lag = 1200.0 + 3000.0 - 22.0 - played;
  EXPECT_NEAR(lag, 0.0, 3.5) << "all but what is borne";
  EXPECT_EQ(clock_.resyncs(), 0u);
  // Three quarters of a second are caught up, no more.
  for (const int more : {0, 1}) {
    clock_.reset();
    arrive(clock_, {5.0});
    const std::uint64_t resyncs = clock_.resyncs();
    played = begin();
    for (int n = 1; n <= 749 + more; ++n) {
      (void)advance(1000.0 + n, 1.0);
      (void)clock_.stand(played);
    }
    (void)advance(1000.0 + 750 + more, 1.0);
    EXPECT_EQ(clock_.resyncs(), resyncs + static_cast<std::uint64_t>(more)) << more;
  }
}

TEST_F(Corrected, ForgetsTheLinkWhenItIsResetAndAtAnotherSamplePeriod) {
  const auto first_cursor = [&] { return advance(3000.0, 1.0); };
  for (const bool by_period : {false, true}) {
    clock_ = PlayoutClock{PlayoutSettings{}};
    arrive(clock_, {5.0, 60.0, 5.0}, true);
    EXPECT_EQ(clock_.depth_samples(), 55 + 17 + 16);
    EXPECT_GE(first_cursor(), 0.0);
    if (!by_period) {
      clock_.reset();
      EXPECT_LT(first_cursor(), 0.0);
      arrive(clock_, {105.0});
      EXPECT_EQ(clock_.depth_samples(), 17) << "neither jitter nor losses";
      EXPECT_EQ(first_cursor(), 3000.0 - 105.0 - 17.0);
    } else {
      clock_.arrived({.now_ns = 15 * 2 * kMs + 105 * kMs,
                      .sent_ns = 15 * 2 * kMs,
                      .last = 15,
                      .count = 16,
                      .sample_period_ns = 2 * kMs});
      EXPECT_EQ(clock_.depth_samples(), 15 + 1);
      EXPECT_EQ(first_cursor(), std::floor((3000.0 - 105.0) / 2.0) - 16.0);
    }
    EXPECT_EQ(clock_.resyncs(), 0u) << "it was not lost, it began anew";
  }
}

}  // namespace
}  // namespace telekerf::streaming
