// SPDX-License-Identifier: Apache-2.0
// The plant's book of the light: where its joules fall, and how each light ended.
#include <gtest/gtest.h>

#include "tools/plant/light_book.h"

namespace telekerf::plant {
namespace {

constexpr std::int64_t kMs = 1'000'000;

class Book : public ::testing::Test {
 protected:
  void light(const Vec2& at_m, double power_w, int ms = 1) {
    book.add(now_ns, now_ns + ms * kMs, at_m, power_w, &contour);
    now_ns += ms * kMs;
  }

  geometry::NearestIndex contour{geometry::Polyline{{Vec2(0.0, 0.0), Vec2(0.01, 0.0)}, false}};
  LightBook book{0.02};
  std::int64_t now_ns = 0;
};

TEST_F(Book, TellsInsideFromOutsideByTheCorridor) {
  light(Vec2(0.005, 0.4999e-3), 10.0);
  EXPECT_EQ(book.outside_j(), 0.0);
  EXPECT_NEAR(book.energy_j(), 0.01, 1e-12);
  light(Vec2(0.005, 0.5001e-3), 10.0, 2);
  EXPECT_NEAR(book.outside_j(), 0.02, 1e-12);
  book.add(now_ns, now_ns + kMs, Vec2(0.005, 0.0), 10.0, nullptr);
  EXPECT_NEAR(book.outside_j(), 0.03, 1e-12) << "as long as no contour is known";
  light(Vec2(0.5, -0.5), 10.0);
  EXPECT_NEAR(book.outside_j(), 0.04, 1e-12) << "beyond the raster";
  book.add(now_ns, now_ns, Vec2::Zero(), 10.0, &contour);
  light(Vec2::Zero(), -1.0);
  EXPECT_NEAR(book.energy_j(), 0.05, 1e-12) << "no time, or no power";
}

TEST_F(Book, SumsWhatFallsWithinATenthOfAMillimetre) {
  light(Vec2(0.002, 0.0), 10.0);
  light(Vec2(0.002, 0.0), 10.0);
  EXPECT_NEAR(book.dose_j(), 0.02, 1e-6);
  light(Vec2(0.0022, 0.0), 10.0);
  EXPECT_NEAR(book.dose_j(), 0.03, 1e-6) << "0.1 mm from the place in between";
  light(Vec2(0.00245, 0.0), 10.0);
  EXPECT_NEAR(book.dose_j(), 0.03, 1e-6);
}

TEST_F(Book, KeepsEachLightWithItsEnd) {
  light(Vec2::Zero(), 10.0);
  light(Vec2(0.001, 0.0), 5.0);
  book.dark(DarkBy::kTold, 0);
  book.dark(DarkBy::kItself, 9 * kMs);  // is dark already
  now_ns += 10 * kMs;
  light(Vec2(0.002, 0.0), 10.0, 3);
  book.dark(DarkBy::kItself, 2 * kMs);
  const auto report = book.report();
  ASSERT_EQ(report["lights"].size(), 2u);
  EXPECT_NEAR(report["lights"][0]["energy_j"].get<double>(), 0.015, 1e-12);
  EXPECT_EQ(report["lights"][0]["dark_by"].get<std::string>(), "told");
  EXPECT_NEAR(report["lights"][1]["from_s"].get<double>(), 0.012, 1e-12);
  EXPECT_NEAR(report["lights"][1]["to_s"].get<double>(), 0.015, 1e-12);
  EXPECT_EQ(report["lights"][1]["dark_by"].get<std::string>(), "itself");
  EXPECT_EQ(report["dark_by_itself"].get<int>(), 1);
  EXPECT_NEAR(report["dark_after_s_max"].get<double>(), 0.002, 1e-12);
  EXPECT_NEAR(report["lit_s"].get<double>(), 0.005, 1e-12);
}

TEST_F(Book, OfMoreLightsThanItKeepsCountsTheEnergyAllTheSame) {
  for (int n = 0; n < 20'010; ++n) {
    light(Vec2::Zero(), 1.0);
    book.dark(DarkBy::kTold, 0);
  }
  EXPECT_EQ(book.report()["lights_unkept"].get<int>(), 10);
  EXPECT_NEAR(book.energy_j(), 20.01, 1e-6);
}

}  // namespace
}  // namespace telekerf::plant
