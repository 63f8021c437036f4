// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
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

TEST(Reference, BelowFourSamplesThereIsNoMotionToBeKnown) {
  for (int count = 1; count <= 5; ++count) {
    auto ring = std::make_unique<JitterBuffer>();
    const auto whole = parabola();
    for (int i = 10; i < 10 + count; ++i) ring->store(i, *whole->find(i));
    const auto motion = reference_at(*ring, 10.0, 1e-3);
    ASSERT_TRUE(motion);
    EXPECT_NEAR(motion->position_m.x(), 0.01 + 0.02 * 0.01 + 1.5e-4, 1e-12);
    EXPECT_NEAR(motion->velocity_m_per_s.x(), count < 4 ? 0.0 : 0.05, 1e-8) << count;
    EXPECT_NEAR(motion->acceleration_m_per_s2.x(), count < 4 ? 0.0 : 3.0, 1e-5) << count;
  }
}

/// Nine samples, four to either side: the least squares of a step are known in closed form (Savitzky-Golay).
TEST(Reference, FourSamplesToEitherSideAreUsedAsFarAsNoneIsMissing) {
  const auto step_at = [](std::int64_t first_one, std::initializer_list<std::int64_t> missing) {
    auto ring = std::make_unique<JitterBuffer>();
    for (std::int64_t i = 0; i < 40; ++i) {
      if (std::find(missing.begin(), missing.end(), i) != missing.end()) continue;
      ring->store(i, {Vec3(i >= first_one ? 1.0 : 0.0, 0, 0), false, true, 1});
    }
    return *reference_at(*ring, 20.0, 1.0);
  };
  // Weights of slope n / 60, of value (59 - 5 n^2) / 231, of curvature 2 (3 n^2 - 20) / 924.
  EXPECT_NEAR(step_at(24, {}).velocity_m_per_s.x(), 4.0 / 60.0, 1e-12) << "only the outermost one is up";
  EXPECT_NEAR(step_at(24, {}).position_m.x(), -21.0 / 231.0, 1e-12);
  EXPECT_NEAR(step_at(24, {}).acceleration_m_per_s2.x(), 2.0 * 28.0 / 924.0, 1e-12);
  EXPECT_EQ(step_at(25, {}).velocity_m_per_s.x(), 0.0) << "the fifth is not used";
  EXPECT_NEAR(step_at(17, {}).velocity_m_per_s.x(), 4.0 / 60.0, 1e-12) << "all but the outermost one";
  EXPECT_NEAR(step_at(16, {}).velocity_m_per_s.x(), 0.0, 1e-12);
  EXPECT_EQ(step_at(23, {22}).velocity_m_per_s.x(), 0.0) << "beyond a gap nothing is used";
  EXPECT_NEAR(step_at(18, {17}).velocity_m_per_s.x(), 0.0, 1e-12);
}

TEST(Reference, TheNearestSampleMustBeThereAndNoOther) {
  const auto ring = parabola();
  const auto broken = std::make_unique<JitterBuffer>();
  for (int i = 0; i < 100; ++i) {
    if (i != 49) broken->store(i, *ring->find(i));
  }
  EXPECT_FALSE(reference_at(*broken, 49.4, 1e-3));
  EXPECT_FALSE(reference_at(*broken, 48.6, 1e-3));
  for (const double cursor : {48.4, 49.6}) {
    const auto motion = reference_at(*broken, cursor, 1e-3);
    ASSERT_TRUE(motion) << cursor;
    EXPECT_NEAR(motion->velocity_m_per_s.x(), 0.02 + 3e-3 * cursor, 1e-8) << cursor;
  }
}

TEST(Reference, SamplesOfAHandThatHasLetGoAreNotMixedIn) {
  const auto ring = parabola();
  StreamSample apart = *ring->find(52);
  apart.engaged = false;
  apart.value = Vec3(5, 5, 5);
  for (int i = 52; i < 60; ++i) ring->store(i, apart);
  EXPECT_NEAR(reference_at(*ring, 51.0, 1e-3)->velocity_m_per_s.x(), 0.02 + 3.0 * 0.051, 1e-8);
  EXPECT_NEAR(reference_at(*ring, 52.0, 1e-3)->velocity_m_per_s.x(), 0.0, 1e-8);
  apart.engaged = true;  // and has taken hold again elsewhere
  for (int i = 53; i < 60; ++i) ring->store(i, apart);
  EXPECT_NEAR(reference_at(*ring, 51.0, 1e-3)->velocity_m_per_s.x(), 0.02 + 3.0 * 0.051, 1e-8);
}

}  // namespace
}  // namespace telekerf::streaming
