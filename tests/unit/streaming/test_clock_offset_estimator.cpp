// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "common/streaming/clock_offset_estimator.h"

namespace telekerf::streaming {
namespace {

TEST(ClockOffsetEstimator, FindsOffsetAndSkewThroughQueues) {
  std::mt19937 random(4);
  std::exponential_distribution<double> queue(1.0 / 2e-3);
  const double offset_s = 123.456;
  const double skew = 40e-6;
  double squares = 0.0;
  double raw_squares = 0.0;
  int judged = 0;
  ClockOffsetEstimator clocks;
  for (int i = 0; i < 2000; ++i) {
    const double sent = 5000.0 + 0.016 * i;
    const double there = sent + 0.01 + queue(random);
    const double answered = there + 0.004;
    const double back = answered + 0.01 + queue(random);
    const auto slave = [&](double t) { return std::llround((t + offset_s + skew * (t - 5000.0)) * 1e9); };
    const auto master = [](double t) { return std::llround(t * 1e9); };
    const FourStamps stamps{master(sent), slave(there), slave(answered), master(back)};
    clocks.add(stamps);
    if (i < 400) continue;
    const ClockEstimate estimate = clocks.estimate(master(back));
    const double truth = offset_s + skew * (back - 5000.0);
    const double raw =
        0.5 * static_cast<double>((stamps.t2_ns - stamps.t1_ns) + (stamps.t3_ns - stamps.t4_ns));
    squares += (estimate.offset_s - truth) * (estimate.offset_s - truth);
    raw_squares += (raw * 1e-9 - truth) * (raw * 1e-9 - truth);
    EXPECT_LT(std::abs(estimate.offset_s - truth), estimate.uncertainty_s);
    ++judged;
  }
  const double rms_us = std::sqrt(squares / judged) * 1e6;
  EXPECT_LT(rms_us, 100.0);
  EXPECT_GT(std::sqrt(raw_squares / judged) * 1e6, 10.0 * rms_us) << "the stamps alone are much worse";
  EXPECT_NEAR(clocks.estimate(5032'000'000'000).skew, skew, 60e-6);
}

TEST(ClockOffsetEstimator, SaysNothingBeforeItKnows) {
  ClockOffsetEstimator clocks;
  clocks.add({0, 100, 200, 300});
  EXPECT_EQ(clocks.estimate(300).offset_s, 0.0);
  EXPECT_EQ(clocks.estimate(300).skew, 0.0);
  EXPECT_EQ(clocks.estimate(300).uncertainty_s, 0.0);
  ClockOffsetEstimator empty;
  for (int n = 0; n < 2; ++n) empty.add({});
  EXPECT_EQ(empty.estimate(0).offset_s, 0.0);
  EXPECT_EQ(empty.estimate(0).uncertainty_s, 0.0) << "nothing is under way";
}

/// Exchanges of which nothing is rounded: sent at t, `there_ns` and `back_ns` under way, answered after 4 ms.
FourStamps exchange(std::int64_t t_ns, std::int64_t offset_ns, std::int64_t there_ns, std::int64_t back_ns) {
  const std::int64_t t2_ns = t_ns + there_ns + offset_ns;
  const std::int64_t t3_ns = t2_ns + 4'000'000;
  return {t_ns, t2_ns, t3_ns, t3_ns - offset_ns + back_ns};
}

TEST(ClockOffsetEstimator, ASteadyLinkIsMeasuredExactlyButForItsAsymmetry) {
  ClockOffsetEstimator clocks;
  for (std::int64_t i = 0; i < 50; ++i) {
    clocks.add(exchange(i * 16'000'000, 7'000'000'000 + i * 16 * 100, 10'000'000, 12'000'000));  // 100 ppm
  }
  const ClockEstimate estimate = clocks.estimate(1'000'000'000);
  EXPECT_NEAR(estimate.skew, 100e-6, 1e-9);
  // In the middle of the exchange, 13 ms after it was sent, the offset was that of its beginning; the link is
  // 1 ms slower on the way back.
  EXPECT_NEAR(estimate.offset_s, 7.0 - 1e-3 + 100e-6 * (1.0 - 0.013), 1e-9);
  EXPECT_NEAR(estimate.uncertainty_s, 11e-3, 1e-8) << "half of 22 ms";
}

TEST(ClockOffsetEstimator, TheLast200ExchangesCount) {
  ClockOffsetEstimator clocks;
  for (int i = 0; i < 500; ++i) {
    EXPECT_EQ(clocks.exchanges(), std::min(i, 200));
    clocks.add(exchange(i * std::int64_t{16'000'000}, i < 300 ? 5'000'000 : 9'000'000, 1'000'000, 1'000'000));
    if (i == 498) {
      EXPECT_NE(clocks.estimate(0).skew, 0.0) << "one of the old ones is left";
    }
  }
  EXPECT_EQ(clocks.exchanges(), 200);
  EXPECT_NEAR(clocks.estimate(8'000'000'000).offset_s, 9e-3, 1e-12);
  EXPECT_NEAR(clocks.estimate(8'000'000'000).skew, 0.0, 1e-12);
}

TEST(ClockOffsetEstimator, IsTheWeightedLeastSquaresOfItsExchanges) {
  std::mt19937 random(8);
  std::uniform_int_distribution<std::int64_t> queue_ns(0, 3'000'000);
  ClockOffsetEstimator clocks;
  std::vector<FourStamps> all;
  long double shortest_s = 1.0L;
  for (std::int64_t i = 0; i < 60; ++i) {
    all.push_back(
        exchange(i * 20'000'000, 50'000'000, 5'000'000 + queue_ns(random), 5'000'000 + queue_ns(random)));
    clocks.add(all.back());
    const FourStamps& s = all.back();
    shortest_s = std::min(shortest_s, 1e-9L * ((s.t4_ns - s.t1_ns) - (s.t3_ns - s.t2_ns)));
  }
  long double w = 0, wt = 0, wy = 0, wtt = 0, wty = 0, wyy = 0;
  for (const FourStamps& s : all) {
    const long double t = 0.5e-9L * (s.t1_ns + s.t4_ns);
    const long double y = 0.5e-9L * ((s.t2_ns - s.t1_ns) + (s.t3_ns - s.t4_ns));
    const long double queued = 1e-9L * ((s.t4_ns - s.t1_ns) - (s.t3_ns - s.t2_ns)) - shortest_s + 100e-6L;
    const long double weight = 1.0L / (queued * queued);
    w += weight, wt += weight * t, wy += weight * y;
    wtt += weight * t * t, wty += weight * t * y, wyy += weight * y * y;
  }
  const long double skew = (w * wty - wt * wy) / (w * wtt - wt * wt);
  const long double base = (wy - skew * wt) / w;
  const long double scatter = (wyy - base * wy - skew * wty) / w;
  const ClockEstimate estimate = clocks.estimate(1'500'000'000);
  EXPECT_NEAR(estimate.skew, static_cast<double>(skew), 1e-8);
  EXPECT_NEAR(estimate.offset_s, static_cast<double>(base + 1.5L * skew), 2e-9);
  EXPECT_NEAR(estimate.uncertainty_s, static_cast<double>(0.5L * shortest_s + std::sqrt(scatter / 60.0L)),
              2e-9);
}

TEST(ClockOffsetEstimator, FromExchangesAtOneTimeNoSkewIsTaken) {
  ClockOffsetEstimator clocks;
  clocks.add(exchange(1000, 5'000'000, 1'000'000, 1'000'000));
  EXPECT_EQ(clocks.estimate(0).uncertainty_s, 0.0) << "nothing is known of one";
  clocks.add(exchange(1000, 7'000'000, 1'000'000, 1'000'000));
  const ClockEstimate estimate = clocks.estimate(1'000'000'000);
  EXPECT_EQ(estimate.skew, 0.0);
  EXPECT_NEAR(estimate.offset_s, 6e-3, 1e-12);
  EXPECT_NEAR(estimate.uncertainty_s, 1e-3 + 1e-3 / std::sqrt(2.0), 1e-12);
}

TEST(ClockOffsetEstimator, TwoExchangesGiveTheLineThroughThemHoweverNearOrUnequal) {
  ClockOffsetEstimator near;  // a microsecond apart
  near.add(exchange(0, 5'000'000, 1'000'000, 1'000'000));
  near.add(exchange(1000, 5'000'010, 1'000'000, 1'000'000));
  EXPECT_NEAR(near.estimate(0).skew, 0.01, 1e-8);
  EXPECT_NEAR(near.estimate(3'000'500).offset_s, 5.000005e-3, 1e-13);
  ClockOffsetEstimator unequal;  // the second has waited for 0.9 s, and weighs a hundred millionth
  unequal.add(exchange(0, 5'000'000, 1'000'000, 1'000'000));
  unequal.add(exchange(1'000'000'000, 6'000'000, 451'000'000, 451'000'000));
  EXPECT_NEAR(unequal.estimate(0).skew, 1e-3 / 1.45, 1e-8);
}

TEST(ClockOffsetEstimator, TheMeanOfTwoIsExactHoweverFarTheyAreApart) {
  ClockOffsetEstimator clocks;
  clocks.add(exchange(0, 0, 1'000'000, 1'000'000));
  clocks.add(exchange(0, 2'000'000'000'000, 1'000'000, 1'000'000));
  EXPECT_NEAR(clocks.estimate(0).offset_s, 1000.0, 1e-9);
}

// The weight of one against all the others' is how well the line's slope is known.
TEST(ClockOffsetEstimator, FromExchangesAtOneTimeButForOneThatWaitedLongNoSkewIsTaken) {
  for (const std::int64_t queued_s : {2, 4, 100}) {
    ClockOffsetEstimator clocks;
    clocks.add(exchange(0, 0, queued_s * 500'000'000, queued_s * 500'000'000));
    clocks.add(exchange(1'000'000'000'000, 5'000'000, 0, 0));
    const ClockEstimate estimate = clocks.estimate(1'000'000'000'000);
    // (100 us / 2 s)^2 is 2.5e-9, (100 us / 4 s)^2 0.6e-9.
    EXPECT_NEAR(estimate.skew, queued_s == 2 ? 5e-3 / 999.0 : 0.0, 2e-8) << queued_s;
    EXPECT_EQ(estimate.skew == 0.0, queued_s != 2) << queued_s;
    EXPECT_NEAR(estimate.offset_s, 5e-3, 1e-7) << queued_s;
  }
}

}  // namespace
}  // namespace telekerf::streaming
