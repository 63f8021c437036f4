// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <thread>

#include "common/bus/ring.h"

namespace telekerf {
namespace {

TEST(Ring, GivesBackInOrderAndCountsWhatDidNotFit) {
  Ring<int> ring(3);
  ASSERT_EQ(ring.capacity(), 4u);
  EXPECT_FALSE(ring.take());
  for (int i = 0; i < 6; ++i) EXPECT_EQ(ring.push(int{i}), i < 4);
  EXPECT_EQ(ring.dropped(), 2u);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(ring.take(), i);
  EXPECT_FALSE(ring.take());
}

TEST(Ring, LosesNothingUncountedBetweenTwoThreads) {
  constexpr std::uint64_t kSent = 200000;
  Ring<std::uint64_t> ring(64);
  std::thread producer([&] {
    for (std::uint64_t i = 1; i <= kSent; ++i) ring.push(std::uint64_t{i});
    while (!ring.push(kSent + 1)) std::this_thread::yield();
  });
  std::uint64_t last = 0;
  std::uint64_t taken = 0;
  while (last != kSent + 1) {
    const auto value = ring.take();
    if (!value) continue;
    ASSERT_GT(*value, last);
    last = *value;
    ++taken;
  }
  producer.join();
  EXPECT_GE(taken + ring.dropped(), kSent + 1);  // the last push may have been refused several times
  EXPECT_LE(taken, kSent + 1);
}

}  // namespace
}  // namespace telekerf
