// SPDX-License-Identifier: Apache-2.0
// Streams of bare accelerations at the selector: integrated if so chosen, let go where they lead out of
// bounds.
#include <cmath>
#include <numbers>

#include "tests/unit/slave/selector_fixture.h"

namespace telekerf::slave {
namespace {

/// The largest way on that a bare acceleration's state may have, in closed form.
double way_on_m(double speed_m_per_s) {
  const double rate_rad_per_s = std::min(100.0, 0.5 * 1.0 / speed_m_per_s);
  return kCoast_s * speed_m_per_s + speed_m_per_s / (std::numbers::e * rate_rad_per_s);
}

TEST_F(Selector, BareAccelerationsAreIntegratedFromWhereTheToolStoodIfSoChosen) {
  selector_ = ReferenceSelector(model(), {}, kDt_s, BareAccelerations::kIntegrated);
  selector_.rest_at(Vec3(1e-3, 0, 0));
  streaming::StreamSample bare = sample(Law::kRemoteAcceleration);
  bare.acceleration_m_per_s2 = Vec3(0.5, 0, 0);
  // The tool lags behind; the reference does not care.
  for (int n = 0; n <= 100; ++n) {
    play(bare, at(1.1e-3, 0.001, 0.5));
    const double t_s = n * kDt_s;
    ASSERT_NEAR(out_.reference.position_m.x(), 1e-3 + 0.25 * t_s * t_s, 1e-12) << n;
    ASSERT_NEAR(out_.reference.velocity_m_per_s.x(), 0.5 * t_s, 1e-12) << n;
    ASSERT_EQ(out_.reference.acceleration_m_per_s2.x(), 0.5) << n;
    ASSERT_TRUE(out_.following);
    ASSERT_FALSE(out_.bare) << "the slave's loop holds the tool to it";
  }
  EXPECT_EQ(out_.source_m, out_.reference.position_m);
  // Another stream: from where the reference is, with its speed.
  bare.generation = 2;
  play(bare, at(0.0, 0.0, 0.5));
  EXPECT_NEAR(out_.reference.position_m.x(), 1e-3 + 0.25 * 0.101 * 0.101, 1e-12);
  EXPECT_NEAR(out_.reference.velocity_m_per_s.x(), 0.5 * 0.101, 1e-12);
  EXPECT_EQ(selector_.offset_m(), 0.0);
}

TEST_F(Selector, BareAccelerationsAreLetGoWhereTheyCouldNotComeToRestWithinBounds) {
  struct Place {
    Vec3 position_m;
    Vec3 velocity_m_per_s;
    bool within;
  };
  const double slow = 1e-3;  // fades at the full rate
  const double fast = 0.02;  // fades at what the acceleration allows
  const double eps = 1e-9;
  for (const Place& place :
       std::initializer_list<Place>{{{0.01 - eps, 0, 0}, {0, 0, 0}, true},
                                    {{0.01, 0, 0}, {0, 0, 0}, false},
                                    {{0, 0.01 - eps, 0}, {0, 0, 0}, true},
                                    {{0, -0.01 - eps, 0}, {0, 0, 0}, false},
                                    {{0.008, 0.006 + eps, 0}, {0, 0, 0}, false},
                                    {{0, 0, 0.005 - eps}, {0, 0, 0}, true},
                                    {{0, 0, 0.005}, {0, 0, 0}, false},
                                    {{0.0095, 0, 0.004}, {0, 0, 0}, true},
                                    {{0, 0, -0.005 + eps}, {0, 0, 0}, true},
                                    {{0, 0, -0.005}, {0, 0, 0}, false},
                                    {{0.01 - way_on_m(slow) - eps, 0, 0}, {slow, 0, 0}, true},
                                    {{0.01 - way_on_m(slow) + eps, 0, 0}, {slow, 0, 0}, false},
                                    {{0.01 - way_on_m(slow) + eps, 0, 0}, {-slow, 0, 0}, true},
                                    {{0.01 - way_on_m(fast) - eps, 0, 0}, {fast, 0, 0}, true},
                                    {{0.01 - way_on_m(fast) + eps, 0, 0}, {fast, 0, 0}, false},
                                    {{0, 0, way_on_m(slow) - 0.005 + eps}, {0, 0, -slow}, true},
                                    {{0, 0, way_on_m(slow) - 0.005 - eps}, {0, 0, -slow}, false}}) {
    selector_ = ReferenceSelector(model(), {}, kDt_s);
    play(sample(Law::kRemoteAcceleration), {place.position_m, place.velocity_m_per_s, Vec3::Zero()});
    EXPECT_EQ(out_.following, place.within) << place.position_m.transpose();
    EXPECT_EQ(out_.applied_tick >= 0.0, place.within) << place.position_m.transpose();
  }
  robot::RobotModel wide = model();
  wide.workspace.radius_m = 1.0;
  for (const double speed : {0.3 - eps, 0.3}) {
    selector_ = ReferenceSelector(wide, {}, kDt_s);
    play(sample(Law::kRemoteAcceleration), at(0.0, speed));
    EXPECT_EQ(out_.following, speed < 0.3) << speed;
  }
}

TEST_F(Selector, WhoWasLetGoHoldsUntilTheMasterHasLetGoToo) {
  const streaming::StreamSample bare = sample(Law::kRemoteAcceleration);
  play(bare, at(0.0));
  EXPECT_TRUE(out_.following);
  play(bare, at(0.02));
  EXPECT_FALSE(out_.following);
  play(bare, at(0.0));
  EXPECT_FALSE(out_.following) << "although it is within bounds again";
  EXPECT_EQ(selector_.mode(), SlaveMode::kHolding);
  EXPECT_EQ(selector_.reason(), HoldReason::kLimits);
  streaming::StreamSample apart = bare;
  apart.engaged = false;
  play(apart, at(0.0));
  play(bare, at(0.0));
  EXPECT_TRUE(out_.following);
  play(sample(Law::kAnchored), at(0.02));
  EXPECT_TRUE(out_.following) << "positions are clamped instead";
}

TEST_F(Selector, WhoWasLetGoDoesNotCoast) {
  const streaming::StreamSample bare = sample(Law::kRemoteAcceleration);
  play(bare, at(1e-3, 0.05));
  EXPECT_TRUE(out_.following);
  play(bare, at(9.9e-3, 0.05));
  EXPECT_FALSE(out_.following);
  for (int n = 0; n < 3; ++n) play(bare, at(9.9e-3, 0.05));
  EXPECT_LT(out_.reference.velocity_m_per_s.x(), 0.0499);
}

}  // namespace
}  // namespace telekerf::slave
