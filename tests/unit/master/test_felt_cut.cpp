// SPDX-License-Identifier: Apache-2.0
// What the hand may be given: never more than was in the tank at the start and what drag has taken.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "master/haptics/felt_cut.h"

namespace telekerf::master {
namespace {

constexpr double kDt_s = 1e-3;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A virtual mass under a force `hand_n`, a drag and what the tank lets through; books the exact balance.
struct Port {
  double mass_kg = 0.5, drag_ns_per_m = 2.0;
  EnergyTank tank;
  double v = 0.0;
  double given_j = 0.0;  ///< by the felt force
  double drag_j = 0.0;

  double mobility() const { return 0.5 * kDt_s / mass_kg; }
  double free(double hand_n) const { return v + mobility() * (hand_n - drag_ns_per_m * v); }
  double step(double hand_n, double wished_n) {
    const double share = tank.share(wished_n, free(hand_n), mobility(), kDt_s);
    EXPECT_GE(share, 0.0);
    EXPECT_LE(share, 1.0);
    const double force = share > 0.0 ? share * wished_n : 0.0;
    const double mean = free(hand_n) + mobility() * force;
    const double taken = std::max(0.0, drag_ns_per_m * v * mean * kDt_s);
    EXPECT_TRUE(tank.pay(force, mean, taken, kDt_s)) << "share " << share << ", wished " << wished_n;
    given_j += force * mean * kDt_s;
    drag_j += taken;
    v = 2.0 * mean - v;
    return force;
  }
};

TEST(EnergyTank, GivesNoMoreThanItHeldAndTheDragTookWhateverIsWished) {
  std::mt19937_64 random(7);
  const auto between = [&](double least, double most) {
    return least + (most - least) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  for (int run = 0; run < 10000; ++run) {
    Port port{.mass_kg = between(0.1, 20.0), .drag_ns_per_m = between(0.0, 200.0), .tank = EnergyTank{}};
    const double loud = std::exp(between(-3.0, 8.0)), push = between(0.0, 30.0);
    for (int k = 0; k < 200; ++k) {
      double wished = between(-loud, loud);
      if (k % 7 == 3) wished = std::copysign(loud, port.v);  // an adversary's
      if (k % 50 == 9) wished = k % 100 < 50 ? kNaN : std::numeric_limits<double>::infinity();
      port.step(between(-push, push), wished);
      ASSERT_LE(port.given_j - port.drag_j, EnergyTankSettings{}.initial_j + 1e-12)
          << "run " << run << ", step " << k;
      ASSERT_GE(port.tank.level_j(), 0.0);
      ASSERT_TRUE(std::isfinite(port.v));
    }
  }
}

TEST(EnergyTank, TheShareIsTheLargestThatFits) {
  std::mt19937_64 random(3);
  const auto between = [&](double least, double most) {
    return least + (most - least) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  int scaled = 0;
  for (int i = 0; i < 20000; ++i) {
    const EnergyTank tank({.initial_j = between(0.0, 1e-4)});
    const double f = between(-10.0, 10.0), free = between(-0.1, 0.1), mobility = between(1e-5, 5e-3);
    const double s = tank.share(f, free, mobility, kDt_s);
    const auto cost_j = [&](double share) { return share * f * (free + share * f * mobility) * kDt_s; };
    ASSERT_LE(cost_j(s), tank.level_j() + 1e-15);
    if (s == 1.0) continue;
    ++scaled;
    ASSERT_GT(cost_j(s + 1e-6), tank.level_j());
  }
  EXPECT_GT(scaled, 1000);
}

TEST(EnergyTank, AFullOneGivesTheWholeForceAndAnEmptyOneNoneThatPushes) {
  const EnergyTank full({.initial_j = 50e-3}), empty({.initial_j = 0.0});
  EXPECT_EQ(full.share(3.0, 0.02, 1e-3, kDt_s), 1.0);
  EXPECT_EQ(empty.share(3.0, 0.02, 1e-3, kDt_s), 0.0);
  EXPECT_EQ(empty.share(-3.0, 0.02, 1e-3, kDt_s), 1.0) << "what brakes pays in";
}

TEST(EnergyTank, KeepsNoMoreThanItsCeiling) {
  EnergyTank tank({.initial_j = 2e-3, .max_j = 5e-3});
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(tank.pay(-3.0, 0.02, 0.0, kDt_s));
  EXPECT_EQ(tank.level_j(), 5e-3);
  EXPECT_FALSE(tank.pay(3.0, 10.0, 0.0, kDt_s)) << "30 mJ";
  EXPECT_EQ(tank.level_j(), 5e-3) << "nothing was booked";
}

class FeltCutTest : public testing::Test {
 protected:
  static constexpr double kBeta = 0.5;
  /// Right is 3 mm2/s / 0.3 mm = 10 mm/s at the work, 20 at the master.
  FeltCut felt_{FeltCutSettings{.depth_m = 0.3e-3, .depth_speed_m2_per_s = 3e-6, .tank = {}}};
  double settled(double speed, double hand_n) {
    double n = 0.0;
    for (int i = 0; i < 500; ++i) n = felt_.wished_n(speed, hand_n, kBeta, true, kDt_s);
    return n;
  }
};

TEST_F(FeltCutTest, BrakesWhatIsTooFastAndHelpsWhatIsTooSlowOnEitherWay) {
  for (const double way : {1.0, -1.0}) {
    EXPECT_NEAR(settled(way * 20e-3, way), 0.0, 1e-9);
    EXPECT_NEAR(way * settled(way * 22e-3, -way), -0.6, 1e-6);
    EXPECT_NEAR(way * settled(way * 18e-3, way), 0.6, 1e-6);
  }
}

TEST_F(FeltCutTest, AHandThatHoldsBackIsNotHelpedOn) {
  for (const double way : {1.0, -1.0}) {
    EXPECT_NEAR(settled(way * 18e-3, -0.2 * way), 0.0, 1e-6);
    EXPECT_NEAR(settled(-way * 2e-3, 0.2 * way), 0.0, 1e-6) << "nor is one that turns round";
    EXPECT_NEAR(way * settled(way * 22e-3, -0.2 * way), -0.6, 1e-6)
        << "what is too fast is braked all the same";
  }
}

TEST_F(FeltCutTest, NeverExceedsItsBoundAndDoesNotSetAToolInMotion) {
  EXPECT_NEAR(settled(0.2, 1.0), -3.0, 1e-6);
  EXPECT_EQ(FeltCut(FeltCutSettings{.depth_m = 0.3e-3, .tank = {}}).wished_n(0.0, 1.0, kBeta, true, kDt_s),
            0.0);
  EXPECT_NEAR(settled(kNaN, 1.0), 0.0, 1e-9);
}

TEST_F(FeltCutTest, FadesWhereTheBeamBeginsAndEnds) {
  double before = 0.0;
  const auto follow = [&](bool cutting) {
    for (int i = 0; i < 200; ++i) {
      const double n = felt_.wished_n(25e-3, 1.0, kBeta, cutting, kDt_s);
      ASSERT_LE(std::abs(n - before), 1.5 * kDt_s / 0.02 + 1e-9);
      before = n;
    }
  };
  follow(true);
  EXPECT_NEAR(before, -1.5, 1e-3);
  follow(false);
  EXPECT_NEAR(before, 0.0, 1e-3);
}

TEST_F(FeltCutTest, WhereALimitBendsTheMotionNothingIsOverdrawn) {
  // The limit throws the tool faster than the tank was asked for: the force is left out then.
  FeltCut felt{FeltCutSettings{.depth_m = 0.3e-3, .tank = {.initial_j = 1e-5}}};
  const auto torn = [](double force_n) { return force_n > 0.0 ? 5.0 : 0.01; };
  for (int i = 0; i < 100; ++i) EXPECT_EQ(felt.step(2.0, 0.01, 0.0, 1e-3, kDt_s, torn), 0.0);
  EXPECT_EQ(felt.tank().level_j(), 1e-5);
  EXPECT_EQ(felt.statistics().held_back, 100u);
}

}  // namespace
}  // namespace telekerf::master
