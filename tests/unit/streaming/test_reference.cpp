// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <memory>

#include "common/streaming/reference.h"

namespace telekerf::streaming {
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

}  // namespace
}  // namespace telekerf::streaming
