// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>

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
}

}  // namespace
}  // namespace telekerf::streaming
