// SPDX-License-Identifier: Apache-2.0
// The account of energy against exposures that are all remembered, and the power that follows the speed.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "slave/laser/beam_power.h"
#include "slave/laser/dose_book.h"
#include "tests/unit/allocations.h"

namespace telekerf::laser {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

struct Exposure {
  Vec2 place_m;
  double energy_j;
};

double within(const std::vector<Exposure>& all, const Vec2& centre_m, double radius_m) {
  double sum_j = 0.0;
  for (const Exposure& one : all) sum_j += (one.place_m - centre_m).norm() <= radius_m ? one.energy_j : 0.0;
  return sum_j;
}

TEST(DoseBook, NoDiscOfATenthOfAMillimetreHasGotMoreThanItSays) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto somewhere = [&] { return Vec2(1e-3 * (unit(random) - 0.5), 1e-3 * (unit(random) - 0.5)); };
  DoseBook book(5e-3);
  std::vector<Exposure> all;
  for (int n = 0; n < 1000; ++n) {
    all.push_back({somewhere(), 1e-3 * unit(random)});
    const auto before = testing::allocations();
    book.add(all.back().place_m, all.back().energy_j);
    ASSERT_EQ(testing::allocations(), before);
  }
  for (int n = 0; n < 40; ++n) {
    const Vec2 place_m = somewhere();
    const DoseBook::Dose dose = book.at(place_m);
    ASSERT_TRUE(dose.kept);
    for (int k = 0; k < 20; ++k) {
      const double angle = 2.0 * M_PI * unit(random);
      const Vec2 centre_m = place_m + 0.1e-3 * unit(random) * Vec2(std::cos(angle), std::sin(angle));
      ASSERT_LE(within(all, centre_m, 0.1e-3), dose.place_j * (1.0 + 1e-5)) << place_m.transpose();
    }
    // Nor does it say much more than the worst disc that is a cell's diagonal larger, looked for on a grid.
    double most_j = 0.0;
    for (double x = -0.2e-3; x <= 0.2e-3; x += 0.03e-3) {
      for (double y = -0.2e-3; y <= 0.2e-3; y += 0.03e-3)
        most_j = std::max(most_j, within(all, place_m + Vec2(x, y), 0.11e-3 + 0.0708e-3 + 0.0213e-3));
    }
    ASSERT_LE(dose.place_j, most_j * (1.0 + 1e-5));
  }
}

TEST(DoseBook, ASquareMillimetreHasTheMeanOfWhatFellOnIt) {
  DoseBook book(5e-3);
  book.add({0.2e-3, 0.2e-3}, 0.5);
  book.add({0.8e-3, 0.9e-3}, 0.25);
  book.add({-0.2e-3, 0.2e-3}, 1.0);
  EXPECT_NEAR(book.at({0.5e-3, 0.5e-3}).area_j_per_mm2, 0.75, 1e-6);
  EXPECT_NEAR(book.at({-0.5e-3, 0.5e-3}).area_j_per_mm2, 1.0, 1e-6);
  EXPECT_EQ(book.at({0.5e-3, -0.5e-3}).area_j_per_mm2, 0.0);
  EXPECT_EQ(book.at({0.5e-3, 0.5e-3}).place_j, 0.0) << "three tenths away";
  book.clear();
  EXPECT_EQ(book.at({0.2e-3, 0.2e-3}).place_j, 0.0);
  EXPECT_EQ(book.at({0.2e-3, 0.2e-3}).area_j_per_mm2, 0.0);
  book.add({0.2e-3, 0.2e-3}, 0.5);
  EXPECT_NEAR(book.at({0.2e-3, 0.2e-3}).place_j, 0.5, 1e-6);
  EXPECT_NEAR(book.at({0.2e-3, 0.2e-3}).area_j_per_mm2, 0.5, 1e-6);
}

TEST(DoseBook, BeyondItsRasterItKeepsNoAccountAndSaysSo) {
  DoseBook book(5e-3);
  for (const Vec2& place_m : {Vec2(5e-3, 0), Vec2(0, -5e-3), Vec2(-4e-3, 3e-3)}) {
    EXPECT_TRUE(book.at(place_m).kept) << place_m.transpose();
    book.add(place_m, 0.5);
  }
  EXPECT_EQ(book.unkept_j(), 0.0);
  for (const Vec2& place_m :
       {Vec2(6.2e-3, 0), Vec2(0, -6.2e-3), Vec2(kNan, 0), Vec2(0, kInfinite), Vec2(1e9, 0)}) {
    EXPECT_FALSE(book.at(place_m).kept) << place_m.transpose();
    book.add(place_m, 0.5);
  }
  EXPECT_EQ(book.unkept_j(), 2.5);
  for (const double none : {0.0, -1.0, kNan, kInfinite}) book.add({0, 0}, none);
  EXPECT_EQ(book.at({0, 0}).place_j, 0.0);
  EXPECT_EQ(book.unkept_j(), 2.5);
}

TEST(DoseBook, AsSoonAsItsMemoryIsUsedUpItKeepsNoAccountOfWhatIsNew) {
  DoseBook book(60e-3);  // more square millimetres than it keeps
  int kept = 0;
  for (int x = -50; x < 50; ++x) {
    for (int y = -50; y < 50; ++y) {
      const Vec2 place_m = 1e-3 * Vec2(x + 0.5, y + 0.5);
      const bool keeps = book.at(place_m).kept;
      if (keeps) book.add(place_m, 0.25);
      kept += keeps ? 1 : 0;
      ASSERT_EQ(book.unkept_j(), 0.0) << "what it says it keeps it keeps";
    }
  }
  EXPECT_NEAR(kept, 4096, 4);
  EXPECT_NEAR(book.at(1e-3 * Vec2(-49.5, -49.5)).place_j, 0.25, 1e-6) << "the first is still there";
  for (int n = 0; n < 5; ++n) book.add(1e-3 * Vec2(49.5 - n, 49.5), 0.25);
  EXPECT_GE(book.unkept_j(), 0.25);
  book.clear();
  EXPECT_TRUE(book.at(1e-3 * Vec2(49.5, 49.5)).kept);
}

TEST(BeamPower, FollowsTheSpeedFromAFloorToHalfAsMuchAgain) {
  const BeamPowerSettings settings;
  EXPECT_EQ(settings.speed_m_per_s, 10e-3);
  EXPECT_EQ(settings.floor_m_per_s, 0.3e-3);
  EXPECT_DOUBLE_EQ(power_fraction(settings, 0.3e-3), 0.03);
  EXPECT_EQ(power_fraction(settings, 5e-3), 0.5);
  EXPECT_EQ(power_fraction(settings, 10e-3), 1.0);
  for (const double fast : {15e-3, 0.1, kInfinite}) EXPECT_EQ(power_fraction(settings, fast), 1.5) << fast;
  for (const double none : {std::nextafter(0.3e-3, 0.0), 0.0, -1.0, kNan, -kInfinite})
    EXPECT_EQ(power_fraction(settings, none), 0.0) << none;
}

TEST(CutSpeed, IsInThePlaneAndForgetsNoiseBeforeItTakesTheMagnitude) {
  CutSpeed speed(1e-3);
  double now = 0.0;
  for (int n = 0; n < 100; ++n) now = speed.step({3e-3, -4e-3, 0.1});
  EXPECT_NEAR(now, 5e-3, 1e-9);
  CutSpeed resting(1e-3);
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 1e-3);
  double sum = 0.0;
  for (int n = 0; n < 2000; ++n) sum += resting.step({noise(random), noise(random), 0.0});
  EXPECT_LT(sum / 2000, 0.45e-3) << "of 1.25 mm/s";
  CutSpeed steps(1e-3);
  EXPECT_NEAR(steps.step({5e-3, 0, 0}), 1e-3, 1e-12) << "four milliseconds' lag";
  EXPECT_EQ(steps.step({kNan, 0, 0}), 0.0);
  EXPECT_NEAR(steps.step({5e-3, 0, 0}), 1e-3, 1e-12) << "from rest again";
}

}  // namespace
}  // namespace telekerf::laser
