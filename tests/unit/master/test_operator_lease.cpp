// SPDX-License-Identifier: Apache-2.0
// The dead-man, in virtual time: silence releases, and what is old moves nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "master/operator/arm.h"
#include "master/operator/operator_lease.h"

namespace telekerf::master {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// A sender whose clock has nothing to do with the receiver's.
class OperatorLeaseTest : public ::testing::Test {
 protected:
  /// A frame that was `late_ms` on its way.
  bool hear(bool held, std::int64_t late_ms = 1) {
    return lease.hear({++sequence, now_ns - late_ms * kMs - 777 * kMs, held}, now_ns);
  }
  void pass(std::int64_t ms) { now_ns += ms * kMs; }

  OperatorLease lease;
  std::uint64_t sequence = 0;
  std::int64_t now_ns = 5000 * kMs;
};

TEST_F(OperatorLeaseTest, HoldsNothingBeforeItWasReleasedOnce) {
  EXPECT_FALSE(lease.held(now_ns));
  EXPECT_TRUE(hear(true));
  EXPECT_FALSE(lease.held(now_ns)) << "who holds it from the start has to press anew";
  EXPECT_TRUE(hear(false));
  EXPECT_TRUE(hear(true));
  EXPECT_TRUE(lease.held(now_ns));
}

TEST_F(OperatorLeaseTest, RunsOutAfterATenthOfASecondAndNotBefore) {
  hear(false);
  hear(true);
  pass(99);
  EXPECT_TRUE(lease.held(now_ns));
  pass(1);
  EXPECT_FALSE(lease.held(now_ns));
}

TEST_F(OperatorLeaseTest, AfterASilenceOneReleasedComesFirst) {
  hear(false);
  hear(true);
  pass(150);
  for (int i = 0; i < 50; ++i, pass(20)) {
    EXPECT_TRUE(hear(true));
    ASSERT_FALSE(lease.held(now_ns));
  }
  hear(false);
  hear(true);
  EXPECT_TRUE(lease.held(now_ns));
}

TEST_F(OperatorLeaseTest, TheQueueOfAStalledLineMovesNothing) {
  for (int i = 0; i < 100; ++i, pass(20)) hear(false);
  // For two seconds the hand pulls, lets go and pulls again, and nothing arrives; then all of it at once.
  const std::int64_t arrival_ns = now_ns + 2000 * kMs;
  int executed = 0;
  for (int age_ms = 2000; age_ms > 0; age_ms -= 20) {
    const bool held = age_ms % 200 != 0;
    const bool counts =
        lease.hear({++sequence, arrival_ns - (age_ms + 1) * kMs - 777 * kMs, held}, arrival_ns);
    EXPECT_EQ(counts, age_ms <= 150) << age_ms;
    if (age_ms > 150) executed += lease.held(arrival_ns) ? 1 : 0;
  }
  EXPECT_EQ(executed, 0);
  EXPECT_EQ(lease.counters().late, 93u);
}

TEST_F(OperatorLeaseTest, ClocksThatDriftApartKeepTheLineAlive) {
  hear(false);
  const double skew = 1.0 + 400e-6;  // as far as cheap quartzes are apart, for ten minutes
  for (int i = 1; i <= 30'000; ++i) {
    const std::int64_t at_ns = 6000 * kMs + std::int64_t{i} * 20 * kMs;
    ASSERT_TRUE(lease.hear(
        {++sequence, static_cast<std::int64_t>(static_cast<double>(at_ns) / skew), i % 2 == 0}, at_ns));
  }
  EXPECT_EQ(lease.counters().late, 0u);
}

TEST_F(OperatorLeaseTest, NumbersThatGoBackCountForNothing) {
  hear(false);
  hear(true);
  EXPECT_FALSE(lease.hear({1, std::nullopt, false}, now_ns));
  EXPECT_FALSE(lease.hear({2, std::nullopt, false}, now_ns));
  EXPECT_TRUE(lease.held(now_ns));
  EXPECT_EQ(lease.counters().overtaken, 2u);
}

TEST_F(OperatorLeaseTest, AnotherSenderBeginsAnew) {
  hear(false);
  hear(true);
  lease.begin();
  EXPECT_FALSE(lease.held(now_ns));
  EXPECT_TRUE(lease.hear({1, now_ns - 123'456 * kMs, true}, now_ns)) << "its clock is another";
  EXPECT_FALSE(lease.held(now_ns));
}

TEST_F(OperatorLeaseTest, AnyTimesAreBorne) {
  constexpr auto kLeast = std::numeric_limits<std::int64_t>::min();
  constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
  for (const std::int64_t sent : {kLeast, kMost, std::int64_t{0}, kLeast, kMost})
    (void)lease.hear({++sequence, sent, true}, now_ns);
  EXPECT_FALSE(lease.held(now_ns));
}

TEST(Arm, PullsTowardsThePointerAndNoHarderThanAWrist) {
  const ArmSettings arm;
  const Vec3 still = Vec3::Zero();
  EXPECT_NEAR(arm_force(arm, {1e-3, 0.0}, still, still).x(), 0.4, 1e-12);
  EXPECT_NEAR(arm_force(arm, {-1.0, 0.0}, still, still).x(), -4.0, 1e-12) << "from the far end of the page";
  EXPECT_NEAR(arm_force(arm, {0.0, 0.0}, still, {0.0, 0.02, 0.0}).y(), -0.4, 1e-12) << "an arm damps";
  EXPECT_EQ(arm_force(arm, {std::nan(""), 0.0}, still, still), Vec3(Vec3::Zero()));
  EXPECT_EQ(arm_force(arm, {INFINITY, 0.0}, still, still), Vec3(Vec3::Zero()));
}

}  // namespace
}  // namespace telekerf::master
