// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
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
  for (const int i : {37, 38, 39, 60, 61}) {
    EXPECT_TRUE(!ring->find(i)->concealed && ring->find(i)->button) << i << " was known and is";
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

bool conceals(int index, int reach, double max_m_per_s2) {
  const auto ring = broken_cubic();
  conceal_gap(*ring, index, 1e-3, reach, max_m_per_s2);
  return ring->find(40) != nullptr && ring->find(59) != nullptr;
}

TEST(Concealment, AGapOfAsManySamplesAsItMayReachIsClosedFromWhereverItIsSeen) {
  for (const int index : {40, 50, 59}) {
    EXPECT_TRUE(conceals(index, 21, 20.0)) << index;
    EXPECT_TRUE(conceals(index, 20, 20.0)) << index;
    EXPECT_FALSE(conceals(index, 19, 20.0)) << index;
  }
}

/// The cubic's acceleration is 6 t, so 0.234 m/s^2 where the gap begins and 0.36 where it ends.
TEST(Concealment, TheHarderEndDecidesWhetherTheWayIsTooHard) {
  EXPECT_TRUE(conceals(50, 100, 0.3601));
  EXPECT_FALSE(conceals(50, 100, 0.3599));
  for (const double max : {0.3599, 0.3601}) {
    JitterBuffer ring;  // the same way backwards
    for (const int i : {39, 60}) {
      const double t = (99 - i) * 1e-3;
      StreamSample sample{Vec3(t * t * t, 0, 0), true, true, 1, 0, Law::kAnchored};
      sample.velocity_m_per_s = Vec3(-3.0 * t * t, 0, 0);
      ring.store(i, sample);
    }
    conceal_gap(ring, 50, 1e-3, 100, max);
    EXPECT_EQ(ring.find(50) != nullptr, max > 0.36) << max;
  }
}

/// Binary fractions, a sample a second: 2.5 m/s^2 at one end and 0.5 m/s^2 at the other.
TEST(Concealment, AsHardAsItMayBeIsNotTooHard) {
  for (const bool at_the_end : {true, false}) {
    for (const double max : {1.25, std::nextafter(1.25, 0.0)}) {
      JitterBuffer ring;
      StreamSample sample{Vec3(0, 0, 0), true, true, 1, 0, Law::kAnchored};
      sample.velocity_m_per_s = Vec3(at_the_end ? 0.0 : 1.0, 0, 0);
      ring.store(10, sample);
      sample.value = Vec3(0.5, 0, 0);
      sample.velocity_m_per_s = Vec3(at_the_end ? 1.0 : 0.0, 0, 0);
      ring.store(12, sample);
      conceal_gap(ring, 11, 1.0, 100, max);
      EXPECT_EQ(ring.find(11) != nullptr, max == 1.25) << at_the_end;
    }
  }
}

TEST(Concealment, BareAccelerationsGoStraightFromEndToEndHoweverHard) {
  JitterBuffer ring;
  for (const int i : {10, 14}) {
    StreamSample sample;
    sample.engaged = sample.button = true;
    sample.law = Law::kRemoteAcceleration;
    sample.acceleration_m_per_s2 = Vec3(100.0 * i, -8.0, 0.0);
    ring.store(i, sample);
  }
  conceal_gap(ring, 12, 1e-3, 100, 1.0);
  for (const int i : {11, 12, 13}) {
    ASSERT_NE(ring.find(i), nullptr);
    EXPECT_NEAR(ring.find(i)->acceleration_m_per_s2.x(), 100.0 * i, 1e-9);
    EXPECT_NEAR(ring.find(i)->acceleration_m_per_s2.y(), -8.0, 1e-12);
    EXPECT_TRUE(ring.find(i)->concealed && !ring.find(i)->button);
  }
}

TEST(Concealment, BothEndsMustBeKnownEngagedAndOfOneLaw) {
  const auto joined = [](auto change) {
    auto ring = broken_cubic();
    for (const int i : {39, 60}) {
      auto other = broken_cubic();
      StreamSample end = *ring->find(i);
      change(end);
      other->store(i, end);
      conceal_gap(*other, 50, 1e-3, 100, 20.0);
      if (other->find(50) != nullptr) return true;
    }
    return false;
  };
  EXPECT_TRUE(joined([](StreamSample&) {}));
  EXPECT_FALSE(joined([](StreamSample& end) { end.engaged = false; }));
  EXPECT_FALSE(joined([](StreamSample& end) { end.generation = 2; }));
  EXPECT_FALSE(joined([](StreamSample& end) { end.law = Law::kLocal; }));
  JitterBuffer ring;
  ring.store(10, *broken_cubic()->find(10));
  conceal_gap(ring, 12, 1e-3, 100, 20.0);
  EXPECT_EQ(ring.find(11), nullptr) << "nothing has come after it";
  conceal_gap(ring, 8, 1e-3, 100, 20.0);
  EXPECT_EQ(ring.find(9), nullptr) << "nothing came before it";
}

TEST(Concealment, WhatWasConcealedIsNoEndOfAnother) {
  const auto ring = broken_cubic();
  conceal_gap(*ring, 50, 1e-3, 100, 20.0);
  StreamSample wrong = *ring->find(45);
  wrong.value = Vec3(1, 1, 1);
  ring->store(45, wrong);
  conceal_gap(*ring, 50, 1e-3, 100, 20.0);
  EXPECT_NEAR(ring->find(45)->value.x(), 45e-3 * 45e-3 * 45e-3, 1e-15);
}

}  // namespace
}  // namespace telekerf::streaming
