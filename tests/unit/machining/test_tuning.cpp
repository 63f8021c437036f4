// SPDX-License-Identifier: Apache-2.0
// Bandwidths of a path follower: as fast as the sensor's noise allows at the speed, within bounds.
#include <gtest/gtest.h>

#include "common/robot/robot_model.h"
#include "slave/machining/tuning.h"

namespace telekerf::machining {
namespace {

PathFollowerSettings at(const robot::RobotModel& model, double mm_s, double ripple = kRipple,
                        double loop_delay = 0.0) {
  PathFollowerSettings settings;
  settings.loop_delay = loop_delay;
  return tuned_for_speed(settings, model, mm_s * 1e-3, ripple);
}

TEST(Tuning, TheFasterThePathTheFasterTheObserverUntilNothingIsGained) {
  robot::RobotModel noisy = robot::load_robot("slave-keops");
  noisy.sensor.kind = robot::Sensor::Kind::kHall;
  noisy.sensor.conversions = 1;
  struct Row {
    double mm_s, observer, velocity, along;
  };
  for (const Row& row : {Row{1, 60, 180, 50}, Row{2, 71.4, 214.2, 55}, Row{4, 131.5, 394.5, 70},
                         Row{8, 265.3, 796, 70}, Row{16, 482.7, 1448.1, 70}, Row{40, 500, 1500, 70}}) {
    const PathFollowerSettings settings = at(noisy, row.mm_s);
    EXPECT_NEAR(settings.observer_rad_s, row.observer, 0.1) << row.mm_s;
    EXPECT_NEAR(settings.velocity_rad_s, row.velocity, 0.3) << row.mm_s;
    EXPECT_NEAR(settings.along_rad_s, row.along, 1e-9) << row.mm_s;
    EXPECT_EQ(settings.across_rad_s, 240.0);
    EXPECT_EQ(settings.control_hz, PathFollowerSettings{}.control_hz);
  }
  EXPECT_GT(at(noisy, 4.0, kRippleAtCorners).observer_rad_s, 1.5 * 131.5) << "more ripple is allowed";
  noisy.sensor.conversions = 16;
  EXPECT_GT(at(noisy, 4.0).observer_rad_s, 1.5 * 131.5) << "a quieter sensor";
  EXPECT_LT(at(noisy, 40.0, kRipple, 4.0).across_rad_s, 240.0) << "a late drive";
}

}  // namespace
}  // namespace telekerf::machining
