// SPDX-License-Identifier: Apache-2.0
// Small laws of motion, against their closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/geometry/interpolation.h"
#include "common/geometry/minimum_jerk.h"
#include "common/geometry/speed_profile.h"

namespace telekerf::geometry {
namespace {

TEST(MinimumJerk, GoesFromRestToRestWithItsOwnDerivatives) {
  EXPECT_EQ(minimum_jerk(0.0).place, 0.0);
  EXPECT_EQ(minimum_jerk(1.0).place, 1.0);
  EXPECT_EQ(minimum_jerk(0.5).place, 0.5);
  double rate = 0.0, rate2 = 0.0;
  constexpr double kH = 1e-4;
  for (double u = 0.0; u <= 1.0; u += 1e-3) {
    const MinimumJerk now = minimum_jerk(u);
    EXPECT_NEAR((minimum_jerk(u + kH).place - minimum_jerk(u - kH).place) / (2 * kH), now.rate, 1e-6);
    EXPECT_NEAR((minimum_jerk(u + kH).rate - minimum_jerk(u - kH).rate) / (2 * kH), now.rate2, 1e-5);
    rate = std::max(rate, now.rate);
    rate2 = std::max(rate2, std::abs(now.rate2));
  }
  EXPECT_NEAR(rate, kMinimumJerkPeakRate, 1e-5);
  EXPECT_NEAR(rate2, kMinimumJerkPeakRate2, 0.01);
  EXPECT_LE(rate2, kMinimumJerkPeakRate2) << "a bound";
  EXPECT_EQ(minimum_jerk(0.0).rate, 0.0);
  EXPECT_EQ(minimum_jerk(1.0).rate, 0.0);
}

TEST(Interpolation, IsExactAtKnotsLinearBetweenAndClampedBeyond) {
  const std::array<double, 4> table{1.0, 3.0, -1.0, 7.0};
  const double places[] = {-5.0, 0.0, 0.25, 1.0, 1.5, 2.0, 2.75, 3.0, 9.0};
  const double values[] = {1.0, 1.0, 1.5, 3.0, 1.0, -1.0, 5.0, 7.0, 7.0};
  for (int i = 0; i < 9; ++i) EXPECT_DOUBLE_EQ(interpolated(table, places[i]), values[i]) << places[i];
}

TEST(SpeedProfile, ABendIsPassedAtTheRootOfItsRadius) {
  EXPECT_DOUBLE_EQ(speed_in_bend(100.0, 4.0), 0.2);
  EXPECT_DOUBLE_EQ(speed_in_bend(-100.0, 4.0), 0.2);
}

TEST(SpeedProfile, SlowsDownAheadOnlyOrBothWays) {
  // v^2 grows by 2 a s a step of 0.5 at 1 m/s^2: by one.
  std::vector<double> ahead{9, 9, 9, 1, 9, 9};
  keep_brakable(ahead, 0.5, 1.0);
  for (int i = 0; i < 6; ++i) EXPECT_DOUBLE_EQ(ahead[i], i > 3 ? 9.0 : std::sqrt(4.0 - i)) << i;
  std::vector<double> both{9, 9, 9, 1, 9, 9};
  keep_brakable_both_ways(both, 0.5, 1.0, false);
  for (int i = 0; i < 6; ++i) EXPECT_DOUBLE_EQ(both[i], std::sqrt(1.0 + std::abs(i - 3))) << i;
  std::vector<double> slow{0.5, 0.5, 0.4, 0.5};  // nothing to do
  keep_brakable_both_ways(slow, 0.5, 1.0, true);
  EXPECT_EQ(slow, (std::vector<double>{0.5, 0.5, 0.4, 0.5}));
}

TEST(SpeedProfile, RoundAClosedLineThereIsNoSeam) {
  for (int slow = 0; slow < 9; ++slow) {
    std::vector<double> speed(9, 9.0);
    speed[slow] = 1.0;
    keep_brakable_both_ways(speed, 0.5, 1.0, true);
    for (int i = 0; i < 9; ++i) {
      const int away = std::min(std::abs(i - slow), 9 - std::abs(i - slow));
      EXPECT_DOUBLE_EQ(speed[i], std::sqrt(1.0 + away)) << slow << " " << i;
    }
  }
  std::vector<double> one{3.0};
  keep_brakable_both_ways(one, 0.5, 1.0, true);
  EXPECT_EQ(one[0], 3.0);
}

}  // namespace
}  // namespace telekerf::geometry
