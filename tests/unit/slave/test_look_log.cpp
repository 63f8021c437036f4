// SPDX-License-Identifier: Apache-2.0
#include "slave/look_log.h"

#include <gtest/gtest.h>

#include <cmath>

#include "slave/laser/interlock.h"

namespace telekerf::slave {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

TelemetryMessage telemetry(const char* role, double id, double age_s) {
  return {.role = role, .tick = 0, .values = {{"frames", 5.0}, {"contour_id", id}, {"look_age_s", age_s}}};
}

TEST(LookLog, TheAgeCountsFromTheLookAndIsOfThatContourAlone) {
  LookLog looks;
  EXPECT_FALSE(std::isfinite(looks.age_s(7, kSecond)));
  looks.hear(telemetry("vision", 7, 0.25), 10 * kSecond);
  EXPECT_NEAR(looks.age_s(7, 10 * kSecond), 0.25, 1e-3);
  EXPECT_NEAR(looks.age_s(7, 13 * kSecond), 3.25, 1e-3);
  EXPECT_FALSE(std::isfinite(looks.age_s(8, 10 * kSecond)));
  looks.hear(telemetry("master", 8, 0.0), 14 * kSecond);
  looks.hear(telemetry("vision", 8, -1.0), 14 * kSecond);
  looks.hear(telemetry("vision", std::nan(""), 0.0), 14 * kSecond);
  EXPECT_NEAR(looks.age_s(7, 14 * kSecond), 4.25, 1e-3) << "none of these is a look";
  looks.hear(telemetry("vision", 4294967295.0, 0.0), 15 * kSecond);
  EXPECT_NEAR(looks.age_s(4294967295U, 15 * kSecond), 0.0, 1e-3);
  EXPECT_FALSE(std::isfinite(looks.age_s(7, 15 * kSecond)));
}

TEST(LookLog, WithoutALimitNobodyAsksAndWithOneAnUnseenContourForbids) {
  using laser::guard_bit;
  laser::InterlockSettings settings;
  laser::InterlockInputs now;
  const auto forbids = [&] {
    return (laser::evaluate_interlock(now, settings).forbidden & guard_bit("look")) != 0;
  };
  EXPECT_FALSE(forbids()) << "unsaid, and not asked for";
  settings.max_look_age_s = 3.0;
  EXPECT_TRUE(forbids()) << "unsaid";
  now.look_age_s = 2.9;
  EXPECT_FALSE(forbids());
  now.look_age_s = 3.1;
  EXPECT_TRUE(forbids());
}

}  // namespace
}  // namespace telekerf::slave
