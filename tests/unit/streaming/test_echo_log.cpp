// SPDX-License-Identifier: Apache-2.0
// The age of a command by the echo of a state: an upper bound, and none for what this process never sent.
#include "common/streaming/echo_log.h"

#include <gtest/gtest.h>

namespace telekerf::streaming {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(EchoLog, TheAgeCountsFromTheStateThatIsEchoed) {
  EchoLog log;
  EXPECT_FALSE(log.age_s(1, 0, 10 * kMs)) << "nothing was sent";
  log.sent(1, 5 * kMs);
  log.sent(2, 21 * kMs);
  EXPECT_DOUBLE_EQ(*log.age_s(1, 5 * kMs, 105 * kMs), 0.1);
  EXPECT_DOUBLE_EQ(*log.age_s(2, 21 * kMs, 21 * kMs), 0.0);
  EXPECT_DOUBLE_EQ(*log.age_s(2, 5 * kMs, 121 * kMs), 0.116) << "a copy of the block before";
}

TEST(EchoLog, WhatItNeverSentTellsNoAge) {
  EchoLog log;
  for (std::uint32_t n = 1; n <= 3000; ++n) log.sent(n, n * kMs);
  const std::int64_t now_ns = 3001 * kMs;
  EXPECT_TRUE(log.age_s(3000, 3000 * kMs, now_ns));
  EXPECT_TRUE(log.age_s(1977, 1977 * kMs, now_ns)) << "the oldest that is remembered";
  EXPECT_FALSE(log.age_s(1976, 1976 * kMs, now_ns)) << "forgotten";
  EXPECT_FALSE(log.age_s(3001, 3000 * kMs, now_ns)) << "not yet sent";
  EXPECT_FALSE(log.age_s(0, 0, now_ns)) << "none is echoed";
  EXPECT_FALSE(log.age_s(3000, 3001 * kMs, now_ns)) << "another stamp than it had";
  EXPECT_FALSE(log.age_s(3000, 3000 * kMs, 2999 * kMs)) << "before it was sent";
  EXPECT_FALSE(log.age_s(3000, 3000 * kMs - 50'000'000'001, now_ns)) << "no copy is that much older";
}

}  // namespace
}  // namespace telekerf::streaming
