// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <memory>

#include "common/streaming/jitter_buffer.h"

namespace telekerf::streaming {
namespace {

TEST(JitterBuffer, HoldsTheNewestAndForgetsWhatWasOverwritten) {
  JitterBuffer ring;
  StreamSample sample;
  for (std::int64_t i = 0; i < 3 * static_cast<std::int64_t>(JitterBuffer::kSize); ++i) {
    sample.value.x() = static_cast<double>(i);
    ring.store(i, sample);
  }
  const std::int64_t end = 3 * static_cast<std::int64_t>(JitterBuffer::kSize);
  EXPECT_EQ(ring.find(end), nullptr);
  EXPECT_EQ(ring.find(-1), nullptr);
  EXPECT_EQ(ring.find(5), nullptr);
  ASSERT_NE(ring.find(end - 1), nullptr);
  EXPECT_EQ(ring.find(end - 1)->value.x(), static_cast<double>(end - 1));
}

}  // namespace
}  // namespace telekerf::streaming
