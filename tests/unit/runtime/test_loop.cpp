// SPDX-License-Identifier: Apache-2.0
// The loop's deadlines: nothing here asks how late a machine wakes up.
#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "common/runtime/clock.h"
#include "common/runtime/loop.h"
#include "common/runtime/real_time.h"

namespace telekerf {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(Loop, TimeThatIsLostIsNeverCaughtUpInABurst) {
  constexpr std::int64_t kPeriod_ns = 40 * kMs;
  constexpr std::size_t kSlow = 3;
  std::vector<std::int64_t> began_ns, told_ns, ended_ns;
  const std::int64_t before_ns = monotonic_ns();
  const LoopStatistics statistics = run_loop(25.0, [&](std::int64_t now_ns) {
    began_ns.push_back(monotonic_ns());
    told_ns.push_back(now_ns);
    if (began_ns.size() == kSlow) sleep_until_ns(began_ns.back() + 210 * kMs);
    ended_ns.push_back(monotonic_ns());
    return began_ns.size() < 10;
  });
  const std::int64_t after_ns = monotonic_ns();
  ASSERT_EQ(began_ns.size(), 10u);
  EXPECT_EQ(statistics.steps, 10u);
  EXPECT_GE(began_ns[kSlow] - ended_ns[kSlow - 1], kPeriod_ns)
      << "the deadlines start anew behind the slow step";
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_GE(told_ns[i], before_ns + static_cast<std::int64_t>(i) * kPeriod_ns) << i;
    EXPECT_LE(told_ns[i], began_ns[i]) << i;
  }
  EXPECT_GE(statistics.overruns, 1u);
  EXPECT_LE(statistics.overruns, 3u) << "one, and what the machine adds: caught up it would be five";
  EXPECT_LE(statistics.slack_min_us, -170e3);
  EXPECT_GT(statistics.slack_min_us, -1e-3 * static_cast<double>(after_ns - before_ns));
  EXPECT_LE(statistics.slack_p99_us, 5.0) << "of what lies below zero the first bin knows no more";
  EXPECT_GE(statistics.late_max_us, 0.0);
  EXPECT_GE(statistics.late_p99_us, statistics.late_p50_us);
  const double rate_hz = 10.0 / (1e-9 * static_cast<double>(after_ns - before_ns));
  EXPECT_GE(statistics.rate_hz, rate_hz);
  EXPECT_LT(statistics.rate_hz, 1.2 * rate_hz);
}

TEST(Loop, TheFirstStepsRefusalIsTheLast) {
  int steps = 0;
  const LoopStatistics statistics = run_loop(1.0, [&](std::int64_t) { return ++steps, false; });
  EXPECT_EQ(steps, 1);
  EXPECT_EQ(statistics.steps, 1u);
  EXPECT_EQ(statistics.overruns, 0u);
  EXPECT_EQ(statistics.slack_min_us, 0.0) << "of no step that was followed by another";
}

TEST(DurationHistogram, QuantilesAreUpperEdgesOfItsBins) {
  DurationHistogram of;
  EXPECT_EQ(of.quantile_us(0.5), 0.0);
  EXPECT_EQ(of.min_us(), 0.0);
  EXPECT_EQ(of.max_us(), 0.0);
  for (const std::int64_t ns : {4'999, 5'000, 12'000, 19'000'000}) of.add(ns);
  EXPECT_EQ(of.quantile_us(0.0), 5.0);
  EXPECT_EQ(of.quantile_us(0.25), 5.0);
  EXPECT_EQ(of.quantile_us(0.26), 10.0);
  EXPECT_EQ(of.quantile_us(0.5), 10.0);
  EXPECT_EQ(of.quantile_us(0.75), 15.0);
  EXPECT_EQ(of.quantile_us(1.0), 19'005.0);
  EXPECT_DOUBLE_EQ(of.min_us(), 4.999);
  EXPECT_DOUBLE_EQ(of.max_us(), 19e3);
  of.add(-7'000);         // below zero: the first bin
  of.add(1'000'000'000);  // beyond 20 ms: the last
  EXPECT_EQ(of.quantile_us(0.1), 5.0);
  EXPECT_EQ(of.quantile_us(1.0), 20'000.0);
  EXPECT_DOUBLE_EQ(of.min_us(), -7.0);
  EXPECT_DOUBLE_EQ(of.max_us(), 1e6);
}

TEST(RealTimePriority, IsThatOfTheThreadAndOfThoseItStartsAndIsGivenBack) {
  const auto policy = [] {
    sched_param parameters{};
    int scheduler = -1;
    pthread_getschedparam(pthread_self(), &scheduler, &parameters);
    return scheduler == SCHED_FIFO ? parameters.sched_priority : 0;
  };
  ASSERT_EQ(policy(), 0);
  {
    const RealTimePriority priority(kNetworkPriority);
    const int expected = priority.granted() ? kNetworkPriority : 0;
    EXPECT_EQ(policy(), expected);
    int inherited = -1;
    std::thread([&] { inherited = policy(); }).join();
    EXPECT_EQ(inherited, expected);
  }
  EXPECT_EQ(policy(), 0);
  EXPECT_LT(kNetworkPriority, kLoopPriority);
}

TEST(Loop, AStopThatIsRequestedStays) {
  EXPECT_FALSE(stop_requested());
  catch_stop_signals();
  EXPECT_FALSE(stop_requested());
  request_stop();
  EXPECT_TRUE(stop_requested());
}

TEST(RealTime, ALimitOfTheKernelIsToldWithItsRemedyAndNoneIsNot) {
  const std::string said = throttling_sentence(950'000, 1'000'000);
  EXPECT_NE(said.find("more than 95 % of the time"), std::string::npos) << said;
  EXPECT_NE(said.find("50 ms of every 1 s (sched_rt_runtime_us = 950000)"), std::string::npos) << said;
  EXPECT_NE(said.find("sysctl -w kernel.sched_rt_runtime_us=-1"), std::string::npos) << said;
  EXPECT_NE(throttling_sentence(0, 1'000'000), "") << "nothing may run at all";
  EXPECT_NE(throttling_sentence(999'999, 1'000'000), "");
  EXPECT_EQ(throttling_sentence(1'000'000, 1'000'000), "");
  EXPECT_EQ(throttling_sentence(-1, 1'000'000), "");
}

TEST(RealTime, WhatIsSaidIsWhatTheSystemGrantsThisProcess) {
  long runtime_us = -1, period_us = 0;
  std::ifstream("/proc/sys/kernel/sched_rt_runtime_us") >> runtime_us;
  std::ifstream("/proc/sys/kernel/sched_rt_period_us") >> period_us;
  std::string all;
  for (const std::string& remark : real_time_remarks()) all += remark + "\n";
  const bool granted = RealTimePriority(kLoopPriority).granted();
  EXPECT_EQ(all.find("priority") == std::string::npos, granted) << all;
  EXPECT_EQ(all.find("sched_rt_runtime_us") != std::string::npos,
            granted && !throttling_sentence(runtime_us, period_us).empty())
      << all;
}

TEST(Deadlines, AreAPeriodApartAndWhatHasPassedIsLeftOut) {
  EXPECT_EQ(next_deadline_ns(1000, 50, 1010), 1050);
  EXPECT_EQ(next_deadline_ns(1000, 50, 1050), 1050);
  EXPECT_EQ(next_deadline_ns(1000, 50, 1300), 1300);
}

}  // namespace
}  // namespace telekerf
