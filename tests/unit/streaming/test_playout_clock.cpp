// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
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
  EXPECT_NEAR(link.lag_late, 50 + 15 + 4 + 2, 0.5);
  EXPECT_EQ(link.clock.depth_samples(), 15 + 4 + 2);
  EXPECT_NEAR(link.clock.wait_s(), 6e-3, 1e-12) << "what is not block filling";
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
  EXPECT_NEAR(link.lag_early, 71.0, 0.5);
  EXPECT_NEAR(link.lag_late, 120.0, 0.5) << "a sample too early is borne";
  EXPECT_NEAR(link.missing, 135, 3);
}

TEST(PlayoutClock, ClockDriftIsCorrectedByWholeTicks) {
  LinkRun link;
  link.run(
      4000, [](int) { return 20 * kMs; }, 100e-6);  // the master's clock is 100 ppm slow
  EXPECT_EQ(link.missing, 0);
  EXPECT_EQ(link.clock.resyncs(), 0u);
  EXPECT_NEAR(static_cast<double>(link.clock.corrections()), 64000 * 100e-6 - 1.5, 1.0);
}

/// The history of 8 s is forgotten first, then a sample is given back every 0.2 s, but for the last three.
TEST(PlayoutClock, TheLagFallsWhenTheDelayFalls) {
  LinkRun link;
  link.run(3000, [](int b) { return (b < 1000 ? 100 : 50) * kMs; });
  EXPECT_EQ(link.clock.resyncs(), 0u);
  EXPECT_NEAR(link.lag_early, 121.0, 0.5);
  EXPECT_NEAR(link.lag_late, 74.0, 0.5);
  EXPECT_EQ(link.clock.corrections(), 47u);
  EXPECT_EQ(link.missing, 0);
}

/// Blocks of 16 samples at 1 kHz that were under way for so many ms.
void arrive(PlayoutClock& clock, std::initializer_list<double> transits_ms, bool lost = false) {
  std::int64_t last = 15;
  for (const double transit_ms : transits_ms) {
    clock.arrived(last * kMs + static_cast<std::int64_t>(transit_ms * kMs), last, 16, kMs, lost);
    last += 16;
  }
}

TEST(PlayoutClock, TheDepthIsBlockFillingLookAheadMarginAndTheQuantileOfTheJitter) {
  for (const int blocks : {1, 2, 100, 200, 512, 700}) {
    PlayoutClock clock{PlayoutSettings{.max_depth_s = 10.0}};
    for (int b = 0; b < blocks; ++b) {
      const std::int64_t last = 16 * b + 15;
      clock.arrived((last + b) * kMs, last, 16, kMs, false);  // later and later by a millisecond
    }
    const int held = std::min(blocks, 512);
    const int spread_ms = static_cast<int>(std::lround(0.995 * (held - 1)));
    EXPECT_EQ(clock.depth_samples(), spread_ms + 15 + 4 + 2) << blocks;
  }
}

TEST(PlayoutClock, FractionsOfASampleAreRoundedUpAndTheDepthIsLimited) {
  PlayoutClock clock{PlayoutSettings{}};
  arrive(clock, {3.0, 3.1});
  EXPECT_EQ(clock.depth_samples(), 22);
  arrive(clock, {3.0, 5000.0});
  EXPECT_EQ(clock.depth_samples(), 2000);
  PlayoutClock sized{PlayoutSettings{.margin_s = 0.01, .lookahead_samples = 7}};
  sized.arrived(0, 7, 8, 2 * kMs, false);
  EXPECT_EQ(sized.depth_samples(), 7 + 7 + 5);
  EXPECT_NEAR(sized.wait_s(), 24e-3, 1e-12);
}

TEST(PlayoutClock, ALossDeepensItByTheCopiesForTenSeconds) {
  PlayoutClock clock{PlayoutSettings{.redundancy = 2}};
  const auto depth = [&](std::int64_t second, bool lost) {
    clock.arrived(second * 1000 * kMs, second * 1000, 16, kMs, lost);
    return clock.depth_samples();
  };
  EXPECT_EQ(depth(1, false), 21);
  EXPECT_EQ(depth(2, true), 21 + 32);
  for (std::int64_t second = 3; second < 12; ++second) EXPECT_EQ(depth(second, false), 21 + 32) << second;
  EXPECT_EQ(depth(12, false), 21);
  EXPECT_EQ(depth(13, true), 21 + 32);
  EXPECT_EQ(depth(22, true), 21 + 32);
  EXPECT_EQ(depth(31, false), 21 + 32) << "each loss counts anew";
  EXPECT_EQ(depth(32, false), 21);
  EXPECT_EQ(depth(33, true), 21 + 32);
  clock.arrived(42'950 * kMs, 42'950, 16, kMs, false);
  EXPECT_EQ(clock.depth_samples(), 21 + 32) << "for the last twentieth of a second too";
}

/// A link that is 5 ms slow: at 1000 ms the cursor is 1000 - 5 - 21.
class Corrected : public testing::Test {
 protected:
  Corrected() { arrive(clock_, {5.0}); }
  /// Negative: not yet.
  double advance(double now_ms, double step_ms, bool underrun = false) {
    return clock_.advance(std::llround(now_ms * 1e6), std::llround(step_ms * 1e6), underrun).value_or(-1.0);
  }
  double begin() { return advance(1000.0, 1.0); }
  PlayoutClock clock_{PlayoutSettings{}};
};

TEST_F(Corrected, BeginsAtAWholeSampleAndGoesOnByTheControlPeriod) {
  EXPECT_DOUBLE_EQ(advance(1000.6, 1.0), 974.0);
  EXPECT_DOUBLE_EQ(advance(1001.6, 1.0), 975.0);
  EXPECT_DOUBLE_EQ(advance(1002.1, 0.5), 975.5);
  EXPECT_EQ(clock_.corrections(), 0u);
  EXPECT_EQ(clock_.resyncs(), 0u);
  PlayoutClock silent{PlayoutSettings{}};
  EXPECT_FALSE(silent.advance(0, kMs, false)) << "nothing has come";
}

TEST_F(Corrected, RunsBackByASampleAtMostEvery20Milliseconds) {
  EXPECT_DOUBLE_EQ(begin(), 974.0);
  EXPECT_DOUBLE_EQ(advance(1019.0, 20.6), 994.6) << "1.6 too far, too soon";
  EXPECT_DOUBLE_EQ(advance(1021.0, 2.0), 995.6) << "a sample back";
  EXPECT_EQ(clock_.corrections(), 1u);
  EXPECT_DOUBLE_EQ(advance(1022.0, 2.0), 997.6) << "1.6 too far again";
  EXPECT_DOUBLE_EQ(advance(1040.0, 18.0), 1015.6);
  EXPECT_DOUBLE_EQ(advance(1042.0, 2.0), 1016.6);
  EXPECT_EQ(clock_.corrections(), 2u);
  EXPECT_DOUBLE_EQ(advance(1100.0, 58.8), 1075.4);
  EXPECT_DOUBLE_EQ(advance(1200.0, 100.0), 1175.4) << "1.4 too far is borne";
  EXPECT_EQ(clock_.corrections(), 2u);
  clock_.reset();
  arrive(clock_, {5.0});
  EXPECT_EQ(begin(), 974.0);
  EXPECT_EQ(advance(1050.0, 51.5), 1025.5) << "and so is one and a half to the very bit";
}

TEST_F(Corrected, TheIntervalItselfIsLongEnoughAndOneAndAHalfIsNotTooFar) {
  EXPECT_DOUBLE_EQ(begin(), 974.0);
  EXPECT_DOUBLE_EQ(advance(1020.0, 21.6), 994.6) << "20 ms, and a sample back";
  EXPECT_DOUBLE_EQ(advance(1220.0, 195.8), 1191.4) << "200 ms, and a sample on";
  EXPECT_EQ(clock_.corrections(), 2u);
  clock_.reset();
  arrive(clock_, {5.0});
  EXPECT_EQ(begin(), 974.0);
  EXPECT_EQ(advance(1001.0, 2.5), 976.5);
  EXPECT_EQ(advance(1001.0, 1.0, true), 977.5) << "without data, one and a half too far: it goes on";
  clock_.reset();
  arrive(clock_, {5.0});
  EXPECT_EQ(begin(), 974.0);
  EXPECT_EQ(advance(1220.0, 216.5), 1190.5) << "three and a half behind";
  clock_.reset();
  arrive(clock_, {5.0});
  EXPECT_EQ(begin(), 974.0);
  EXPECT_EQ(advance(1001.0, 2.625), 976.625);
  EXPECT_EQ(advance(1001.0, 1.0, true), 976.625) << "without data, more than that too far: it waits";
  for (int n = 1; n <= 4; ++n) {
    const std::uint64_t corrections = clock_.corrections();
    EXPECT_EQ(advance(1001.0, 0.25, true), 976.625);
    EXPECT_EQ(clock_.corrections() - corrections, n == 4 ? 1u : 0u) << n;
  }
  const std::uint64_t before = clock_.corrections();
  for (int n = 1; n <= 3; ++n) {
    EXPECT_EQ(advance(1001.0, 0.475, true), 976.625);
    EXPECT_EQ(clock_.corrections() - before, n < 3 ? 0u : 1u) << n;
  }
  const PlayoutClock silent{PlayoutSettings{}};
  EXPECT_EQ(silent.wait_s(), 0.0);
  EXPECT_EQ(silent.depth_samples(), 0);
}

TEST_F(Corrected, CatchesUpByASampleAtMostEvery200Milliseconds) {
  EXPECT_DOUBLE_EQ(begin(), 974.0);
  EXPECT_DOUBLE_EQ(advance(1199.0, 195.4), 1169.4) << "3.6 behind, too soon";
  EXPECT_DOUBLE_EQ(advance(1201.0, 2.0), 1172.4) << "a sample on";
  EXPECT_DOUBLE_EQ(advance(1202.0, 0.0), 1172.4) << "3.6 behind again";
  EXPECT_DOUBLE_EQ(advance(1400.0, 198.0), 1370.4);
  EXPECT_DOUBLE_EQ(advance(1402.0, 2.0), 1373.4);
  EXPECT_EQ(clock_.corrections(), 2u);
  EXPECT_DOUBLE_EQ(advance(1600.0, 197.2), 1570.6) << "3.4 behind is borne";
  EXPECT_EQ(clock_.corrections(), 2u);
}

TEST_F(Corrected, WithoutDataItWaitsWhereItRanTooEarlyAndCountsWholeSamples) {
  EXPECT_DOUBLE_EQ(begin(), 974.0);
  EXPECT_DOUBLE_EQ(advance(1001.0, 2.4), 976.4);
  EXPECT_DOUBLE_EQ(advance(1001.0, 1.0, true), 977.4) << "1.4 too far: none of its business";
  EXPECT_DOUBLE_EQ(advance(1001.0, 0.5, true), 977.4) << "2.4 too far: it waits";
  EXPECT_EQ(clock_.corrections(), 0u);
  EXPECT_DOUBLE_EQ(advance(1001.0, 0.5, true), 977.4);
  EXPECT_EQ(clock_.corrections(), 1u);
  EXPECT_DOUBLE_EQ(advance(1001.5, 0.25, true), 977.4);
  EXPECT_EQ(clock_.corrections(), 1u);
  EXPECT_DOUBLE_EQ(advance(1002.0, 1.0, true), 978.4) << "1.4 too far";
  EXPECT_DOUBLE_EQ(advance(1020.5, 19.5), 997.9) << "too far, but it has waited at 1001 ms";
  EXPECT_DOUBLE_EQ(advance(1021.5, 0.5), 997.4);
}

TEST_F(Corrected, BeyondAQuarterOfASecondItBeginsAnew) {
  EXPECT_DOUBLE_EQ(begin(), 974.0);
  EXPECT_DOUBLE_EQ(advance(1250.0, 0.0), 975.0) << "250 behind: a sample on, as ever";
  EXPECT_EQ(clock_.resyncs(), 0u);
  EXPECT_DOUBLE_EQ(advance(1251.6, 1.0), 1225.0) << "and 250.6 behind it has given up";
  EXPECT_EQ(clock_.resyncs(), 1u);
  EXPECT_DOUBLE_EQ(advance(1001.0, 1.0), 1226.0) << "250 too far";
  EXPECT_EQ(clock_.resyncs(), 1u);
  EXPECT_DOUBLE_EQ(advance(1000.0, 1.0), 974.0);
  EXPECT_EQ(clock_.resyncs(), 2u);
  EXPECT_EQ(clock_.corrections(), 1u);
}

TEST_F(Corrected, ForgetsTheLinkWhenItIsResetAndAtAnotherSamplePeriod) {
  const auto first_cursor = [&] { return advance(3000.0, 1.0); };
  for (const bool by_period : {false, true}) {
    clock_ = PlayoutClock{PlayoutSettings{}};
    arrive(clock_, {5.0, 60.0, 5.0}, true);
    EXPECT_EQ(clock_.depth_samples(), 55 + 21 + 16);
    EXPECT_GE(first_cursor(), 0.0);
    if (!by_period) {
      clock_.reset();
      EXPECT_LT(first_cursor(), 0.0);
      arrive(clock_, {105.0});
      EXPECT_EQ(clock_.depth_samples(), 21) << "neither jitter nor losses";
      EXPECT_EQ(first_cursor(), 3000.0 - 105.0 - 21.0);
    } else {
      clock_.arrived(15 * 2 * kMs + 105 * kMs, 15, 16, 2 * kMs, false);
      EXPECT_EQ(clock_.depth_samples(), 15 + 4 + 1);
      EXPECT_EQ(first_cursor(), std::floor((3000.0 - 105.0) / 2.0) - 20.0);
    }
    EXPECT_EQ(clock_.resyncs(), 0u) << "it was not lost, it began anew";
  }
}

}  // namespace
}  // namespace telekerf::streaming
