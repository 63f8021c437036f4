// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <memory>

#include "common/streaming/reference.h"

namespace telekerf::slave {
namespace {

/// 100 samples of the parabola p + v t + a t^2 / 2 at 1 kHz.
std::unique_ptr<JitterBuffer> parabola() {
  auto ring = std::make_unique<JitterBuffer>();
  for (int i = 0; i < 100; ++i) {
    const double t = i * 1e-3;
    ring->store(i,
                {Vec3(0.01 + 0.02 * t + 0.5 * 3.0 * t * t, -0.01 * t, 0.5 * -2.0 * t * t), false, true, 1});
  }
  return ring;
}

TEST(Reference, ParabolasComeBackExactlyAlsoBetweenSamplesAndAtTheEdges) {
  const auto ring = parabola();
  for (const double cursor : {0.0, 0.4, 3.0, 50.0, 50.3, 98.6, 99.0}) {
    const auto motion = reference_at(*ring, cursor, 1e-3);
    ASSERT_TRUE(motion) << cursor;
    const double t = cursor * 1e-3;
    EXPECT_NEAR(motion->position_m.x(), 0.01 + 0.02 * t + 1.5 * t * t, 1e-12) << cursor;
    EXPECT_NEAR(motion->velocity_m_per_s.x(), 0.02 + 3.0 * t, 1e-8) << cursor;
    EXPECT_NEAR(motion->acceleration_m_per_s2.x(), 3.0, 1e-5) << cursor;
    EXPECT_NEAR(motion->acceleration_m_per_s2.z(), -2.0, 1e-5) << cursor;
  }
}

TEST(Reference, AMissingSampleIsSaidAndAnotherGenerationIsNotMixedIn) {
  const auto ring = parabola();
  EXPECT_FALSE(reference_at(*ring, 100.0, 1e-3));
  ring->store(100, {Vec3(5, 5, 5), false, true, 2});
  const auto motion = reference_at(*ring, 99.0, 1e-3);
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->velocity_m_per_s.x(), 0.02 + 3.0 * 0.099, 1e-8);
}

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

TEST(Bridge, JoinsTheStatesOnBothSidesAndNeverWithTheLaser) {
  const auto ring = broken_cubic();
  bridge_gap(*ring, 50, 1e-3, 100, 20.0);
  for (int i = 40; i < 60; ++i) {
    const StreamSample* sample = ring->find(i);
    ASSERT_NE(sample, nullptr) << i;
    const double t = i * 1e-3;
    EXPECT_NEAR(sample->value.x(), t * t * t, 1e-15);
    EXPECT_NEAR(sample->velocity_m_per_s.x(), 3.0 * t * t, 1e-12);
    EXPECT_NEAR(sample->acceleration_m_per_s2.x(), 6.0 * t, 1e-10);
    EXPECT_TRUE(sample->bridged && sample->engaged && !sample->button) << i;
  }
}

TEST(Bridge, LeavesAloneWhatItCannotKnow) {
  const auto untouched = [](const JitterBuffer& ring) { return ring.find(50) == nullptr; };
  auto ring = broken_cubic();
  bridge_gap(*ring, 50, 1e-3, 10, 20.0);
  EXPECT_TRUE(untouched(*ring)) << "too long";
  bridge_gap(*ring, 50, 1e-3, 100, 0.1);
  EXPECT_TRUE(untouched(*ring)) << "too hard";
  StreamSample after = *ring->find(60);
  after.engaged = false;
  ring->store(60, after);
  bridge_gap(*ring, 50, 1e-3, 100, 20.0);
  EXPECT_TRUE(untouched(*ring)) << "let go meanwhile";
  after.engaged = true;
  after.generation = 2;
  ring->store(60, after);
  bridge_gap(*ring, 50, 1e-3, 100, 20.0);
  EXPECT_TRUE(untouched(*ring)) << "another scale";
}

}  // namespace
}  // namespace telekerf::slave
