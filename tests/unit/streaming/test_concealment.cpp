// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <memory>

#include "common/streaming/concealment.h"

namespace telekerf::streaming {
namespace {

/// A cubic's states at 1 kHz, anchored, with the samples 40 ... 59 missing.
std::unique_ptr<JitterBuffer> broken_cubic() {
  auto ring = std::make_unique<JitterBuffer>();
  for (int i = 0; i < 100; ++i) {
    if (i >= 40 && i < 60) continue;
    const double t = i * 1e-3;
    StreamSample sample{Vec3(t * t * t, 0.02 * t, 0.0), true, true, 1, 0, Law::kAnchored};
    sample.velocity_m_per_s = Vec3(3.0 * t * t, 0.02, 0.0);
    ring->store(i, sample);
  }
  return ring;
}

TEST(Concealment, JoinsTheStatesOnBothSidesAndNeverWithTheLaser) {
  const auto ring = broken_cubic();
  conceal_gap(*ring, 50, 1e-3, 100, 20.0);
  for (int i = 40; i < 60; ++i) {
    const StreamSample* sample = ring->find(i);
    ASSERT_NE(sample, nullptr) << i;
    const double t = i * 1e-3;
    EXPECT_NEAR(sample->value.x(), t * t * t, 1e-15);
    EXPECT_NEAR(sample->velocity_m_per_s.x(), 3.0 * t * t, 1e-12);
    EXPECT_NEAR(sample->acceleration_m_per_s2.x(), 6.0 * t, 1e-10);
    EXPECT_TRUE(sample->concealed && sample->engaged && !sample->button) << i;
  }
}

TEST(Concealment, LeavesAloneWhatItCannotKnow) {
  const auto untouched = [](const JitterBuffer& ring) { return ring.find(50) == nullptr; };
  auto ring = broken_cubic();
  conceal_gap(*ring, 50, 1e-3, 10, 20.0);
  EXPECT_TRUE(untouched(*ring)) << "too long";
  conceal_gap(*ring, 50, 1e-3, 100, 0.1);
  EXPECT_TRUE(untouched(*ring)) << "too hard";
  StreamSample after = *ring->find(60);
  after.engaged = false;
  ring->store(60, after);
  conceal_gap(*ring, 50, 1e-3, 100, 20.0);
  EXPECT_TRUE(untouched(*ring)) << "let go meanwhile";
  after.engaged = true;
  after.generation = 2;
  ring->store(60, after);
  conceal_gap(*ring, 50, 1e-3, 100, 20.0);
  EXPECT_TRUE(untouched(*ring)) << "another scale";
}

}  // namespace
}  // namespace telekerf::streaming
