// SPDX-License-Identifier: Apache-2.0
// Which control step counts as late, and for how long the beam is off after it: to the nanosecond.
#include "slave/laser/punctuality.h"

#include <gtest/gtest.h>

#include <utility>

#include "slave/laser/udp_laser.h"

namespace telekerf::laser {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(Punctuality, TheFirstStepIsNeverLateWhateverTheClockSays) {
  for (const std::int64_t now_ns : {std::int64_t{0}, kMs, 5000 * kMs}) {
    Punctuality steps(kMs);
    EXPECT_TRUE(steps.step(now_ns)) << now_ns;
    EXPECT_EQ(steps.late_steps(), 0u);
  }
}

TEST(Punctuality, AStepIsLateAfterThreeMillisecondsOrThreePeriods) {
  for (const auto& [period_ns, patience_ns] :
       {std::pair{kMs / 10, 3 * kMs}, {kMs, 3 * kMs}, {kMs + 1, 3 * kMs + 3}, {5 * kMs, 15 * kMs}}) {
    Punctuality steps(period_ns);
    EXPECT_TRUE(steps.step(7 * kMs));
    EXPECT_TRUE(steps.step(7 * kMs + patience_ns)) << period_ns;
    EXPECT_EQ(steps.late_steps(), 0u);
    EXPECT_FALSE(steps.step(7 * kMs + 2 * patience_ns + 1)) << period_ns;
    EXPECT_EQ(steps.late_steps(), 1u);
  }
}

TEST(Punctuality, AStepThatFollowsTheFirstLateIsLateToo) {
  Punctuality steps(kMs);
  EXPECT_TRUE(steps.step(0));
  EXPECT_FALSE(steps.step(3 * kMs + 1));
}

TEST(Punctuality, AfterOneThatWasLateTheBeamIsOffForTwentyMilliseconds) {
  Punctuality steps(kMs);
  std::int64_t now_ns = 100 * kMs;
  EXPECT_TRUE(steps.step(now_ns));
  now_ns += 4 * kMs;
  EXPECT_FALSE(steps.step(now_ns));
  for (int n = 1; n < 20; ++n) EXPECT_FALSE(steps.step(now_ns + n * kMs)) << n;
  EXPECT_FALSE(steps.step(now_ns + 20 * kMs - 1));
  EXPECT_TRUE(steps.step(now_ns + 20 * kMs));
  EXPECT_EQ(steps.late_steps(), 1u);
}

/// At a millisecond's period the two agree: a step that is not late has not let the laser go dark.
TEST(Punctuality, IsAsPatientAsALaser) {
  Punctuality steps(kMs);
  EXPECT_TRUE(steps.step(0));
  EXPECT_TRUE(steps.step(udp_silence_ns(kMs)));
  EXPECT_FALSE(steps.step(2 * udp_silence_ns(kMs) + 1));
}

}  // namespace
}  // namespace telekerf::laser
