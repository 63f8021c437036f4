// SPDX-License-Identifier: Apache-2.0
// From what the stream plays to what is followed: modes, changes of source, coasting, limits.
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <tuple>

#include "tests/unit/slave/selector_fixture.h"

namespace telekerf::slave {
namespace {

TEST_F(Selector, TheModeIsWhatStreamAndEventsSay) {
  streaming::StreamSample engaged = sample();
  streaming::StreamSample apart = sample();
  apart.engaged = false;
  EXPECT_EQ(selector_.mode(), SlaveMode::kWaiting);
  miss(false);
  EXPECT_EQ(selector_.mode(), SlaveMode::kWaiting) << "who does not follow has nothing to hold on to";
  EXPECT_EQ(selector_.reason(), HoldReason::kSilent);
  play(engaged, at(0.0));
  EXPECT_EQ(selector_.mode(), SlaveMode::kFollowing);
  EXPECT_EQ(selector_.reason(), HoldReason::kNone);
  miss();
  EXPECT_EQ(selector_.mode(), SlaveMode::kFollowing) << "a sample is missing, the stream is there";
  miss(false);
  EXPECT_EQ(selector_.mode(), SlaveMode::kHolding);
  miss();
  EXPECT_EQ(selector_.mode(), SlaveMode::kHolding);
  play(engaged, at(0.0));
  EXPECT_EQ(selector_.mode(), SlaveMode::kFollowing);
  play(apart, at(0.0));
  EXPECT_EQ(selector_.mode(), SlaveMode::kWaiting);
  EXPECT_EQ(selector_.reason(), HoldReason::kNotEngaged);
  play(engaged, at(0.0));
  now_.stopped = true;
  for (const auto* each : {&engaged, &apart}) {
    EXPECT_FALSE(play(*each, at(0.0)).following);
    EXPECT_EQ(selector_.mode(), SlaveMode::kStopped) << "latched";
    EXPECT_LT(out_.applied_tick, 0.0);
  }
  miss(false);
  EXPECT_EQ(selector_.mode(), SlaveMode::kStopped);
  EXPECT_EQ(selector_.reason(), HoldReason::kStopped);
  now_.stopped = false;
  miss(false);
  EXPECT_EQ(selector_.mode(), SlaveMode::kWaiting);
  play(engaged, at(0.0));
  EXPECT_EQ(selector_.mode(), SlaveMode::kHolding) << "the engagement from before leads no more";
  EXPECT_EQ(selector_.reason(), HoldReason::kNeedsEngage);
  EXPECT_LT(out_.applied_tick, 0.0);
  engaged.engage = 2;
  play(engaged, at(0.0));
  EXPECT_EQ(selector_.mode(), SlaveMode::kFollowing);
}

TEST_F(Selector, WhatIsFollowedIsSaidOfEachStep) {
  streaming::StreamSample local = sample();
  local.button = true;
  play(local, at(0.0, 0.0, 3.0));
  EXPECT_TRUE(out_.following);
  EXPECT_FALSE(out_.bare);
  EXPECT_TRUE(out_.button);
  EXPECT_EQ(out_.applied_tick, 2.0);
  EXPECT_EQ(out_.acceleration_m_per_s2.x(), 3.0);
  EXPECT_EQ(out_.acknowledgement.index, 1);
  EXPECT_EQ(out_.acknowledgement.age, 0);
  streaming::StreamSample concealed = local;
  concealed.concealed = true;
  concealed.button = false;
  play(concealed, at(0.0));
  EXPECT_TRUE(out_.following);
  EXPECT_FALSE(out_.button);
  EXPECT_EQ(out_.acknowledgement.index, 1) << "what bridges a gap is no command";
  EXPECT_EQ(out_.acknowledgement.age, 0);
  EXPECT_EQ(selector_.missed_ticks(), 1u);
  miss();
  EXPECT_FALSE(out_.following);
  EXPECT_FALSE(out_.button);
  EXPECT_LT(out_.applied_tick, 0.0);
  EXPECT_EQ(out_.acknowledgement.age, 1);
  EXPECT_EQ(selector_.missed_ticks(), 2u);
  miss(false);
  EXPECT_EQ(selector_.missed_ticks(), 2u) << "where nothing is played, nothing is missed";
  miss();
  EXPECT_EQ(selector_.missed_ticks(), 2u) << "nor where nothing is followed";
  play(sample(Law::kRemoteAcceleration), at(0.0));
  EXPECT_TRUE(out_.following && out_.bare);
  streaming::StreamSample apart = sample();
  apart.engaged = false;
  play(apart, at(0.0));
  EXPECT_FALSE(out_.following || out_.bare);
}

TEST_F(Selector, ASampleThatGoesOnIsTheReferenceItself) {
  const streaming::StreamSample local = sample();
  for (int n = 0; n < 3000; ++n) play(local, at(0.0));
  play(local, at(1e-5, 0.01, 2.0));
  EXPECT_NEAR(out_.reference.position_m.x(), 1e-5, 1e-15);
  EXPECT_NEAR(out_.reference.velocity_m_per_s.x(), 0.01, 1e-12);
  EXPECT_NEAR(out_.reference.acceleration_m_per_s2.x(), 2.0, 1e-9);
}

/// As from two senders whose samples are told apart by nothing.
TEST_F(Selector, NoRobotIsLedByAJumpWithinASource) {
  for (const Law law : {Law::kLocal, Law::kAnchored}) {
    selector_ = ReferenceSelector(model(), {}, kDt_s);
    const streaming::StreamSample one = sample(law);
    for (int n = 0; n < 3000; ++n) play(one, at(0.0));
    play(one, at(2.1 * model().limits.velocity_m_per_s * kDt_s));
    EXPECT_NEAR(out_.reference.position_m.x(), 0.0, 1e-6) << "taken up";
    for (int n = 0; n < 3000; ++n) play(one, at(0.0));
    ASSERT_LT(selector_.offset_m(), 1e-9);
    const double farthest_m = 1.9 * model().limits.velocity_m_per_s * kDt_s;
    play(one, at(farthest_m));
    EXPECT_NEAR(out_.reference.position_m.x(), farthest_m, 1e-9) << "twice as fast as the robot is a jump";
  }
}

TEST_F(Selector, WhatNoRobotCanDoIsNotFollowedAndWhatComesThenIs) {
  const robot::RobotModel& robot = model();
  for (const Law law : {Law::kLocal, Law::kAnchored}) {
    selector_ = ReferenceSelector(model(), {}, kDt_s);
    const streaming::StreamSample one = sample(law);
    play(one, at(0.0));
    const double speed = robot.limits.velocity_m_per_s, acceleration = robot.limits.acceleration_m_per_s2;
    for (const auto& [v, a, followed] :
         std::initializer_list<std::tuple<double, double, bool>>{{0.99 * speed, 0.0, true},
                                                                 {-1.01 * speed, 0.0, false},
                                                                 {0.0, -0.99 * acceleration, true},
                                                                 {0.0, 1.01 * acceleration, false},
                                                                 {1e13, 0.0, false},
                                                                 {0.0, 0.0, true}}) {
      play(one, at(0.0, v, a));
      EXPECT_EQ(out_.following, followed) << v << " m/s, " << a << " m/s2";
      EXPECT_EQ(selector_.reason(), followed ? HoldReason::kNone : HoldReason::kLimits);
      EXPECT_LE(out_.reference.velocity_m_per_s.norm(), 1.1 * speed);
    }
  }
}

/// The source goes 0.1 mm aside: an offset takes it up where the sources are two, and nothing where they are
/// one.
TEST_F(Selector, AChangeOfSourceIsTakenUpByAnOffset) {
  struct Change {
    const char* what;
    Law law;
    void (*change)(streaming::StreamSample&);
    bool discontinuity;
    bool taken_up;
  };
  const auto nothing = [](streaming::StreamSample&) {};
  const auto generation = [](streaming::StreamSample& next) { next.generation = 2; };
  const auto block = [](streaming::StreamSample& next) { next.block = 2; };
  for (const Change& each :
       std::initializer_list<Change>{{"nothing", Law::kLocal, nothing, false, false},
                                     {"nothing", Law::kAnchored, nothing, false, false},
                                     {"nothing", Law::kRemoteAcceleration, nothing, false, false},
                                     {"generation", Law::kLocal, generation, false, true},
                                     {"generation", Law::kAnchored, generation, false, true},
                                     {"generation", Law::kRemoteAcceleration, generation, false, true},
                                     {"block", Law::kLocal, block, false, false},
                                     {"block", Law::kAnchored, block, false, true},
                                     {"block", Law::kRemoteAcceleration, block, false, false},
                                     {"gap", Law::kLocal, nothing, true, true},
                                     {"gap", Law::kAnchored, nothing, true, true},
                                     {"gap", Law::kRemoteAcceleration, nothing, true, false}}) {
    selector_ = ReferenceSelector(model(), {}, kDt_s);
    streaming::StreamSample next = sample(each.law);
    play(next, at(0.0, 0.02));
    for (int n = 0; n < 3000; ++n) play(next, at(0.0, 0.0));
    ASSERT_LT(selector_.offset_m(), 1e-9);
    each.change(next);
    play(next, at(1e-4), each.discontinuity);
    EXPECT_NEAR(selector_.offset_m(), each.taken_up ? 1e-4 : 0.0, 1e-8) << each.what;
    EXPECT_NEAR(out_.reference.position_m.x(), each.taken_up ? 0.0 : 1e-4, 1e-8) << each.what;
  }
  selector_ = ReferenceSelector(model(), {}, kDt_s);
  play(sample(Law::kLocal), at(0.0));
  play(sample(Law::kAnchored), at(1e-3));
  EXPECT_NEAR(selector_.offset_m(), 1e-3, 1e-8) << "another law";
}

TEST_F(Selector, TheFirstSampleIsApproachedFromWhereTheToolRests) {
  selector_.rest_at(Vec3(-2e-3, 1e-3, 0.0));
  EXPECT_EQ(selector_.reference().position_m, Vec3(-2e-3, 1e-3, 0.0));
  play(sample(), at(3e-3));
  EXPECT_LT((out_.reference.position_m - Vec3(-2e-3, 1e-3, 0.0)).norm(), 1e-12);
  EXPECT_NEAR(selector_.offset_m(), std::hypot(5e-3, 1e-3), 1e-12);
}

TEST_F(Selector, WhereSamplesAreMissingItGoesOnFor100MillisecondsAndThenComesToRest) {
  const streaming::StreamSample local = sample();
  play(local, at(0.0, 0.02));
  for (int n = 0; n < 2000; ++n) play(local, at(0.0, 0.02));  // nothing is left of the approach
  for (int n = 1; n <= 99; ++n) {
    miss();
    ASSERT_NEAR(out_.reference.position_m.x(), n * 0.02 * kDt_s, 1e-9) << n;
    ASSERT_NEAR(out_.reference.velocity_m_per_s.x(), 0.02, 1e-6) << n;
  }
  miss();
  EXPECT_NEAR(out_.reference.velocity_m_per_s.x(), 0.02, 1e-6) << "the fade begins";
  miss();
  EXPECT_LT(out_.reference.velocity_m_per_s.x(), 0.0199);
  const double from_m = 99 * 0.02 * kDt_s;
  double largest_m = 0.0;
  for (int n = 0; n < 2000; ++n) {
    miss();
    largest_m = std::max(largest_m, out_.reference.position_m.x());
  }
  // (o + (v + w o) t) e^(-w t) with o = v dt and w = 0.5 x 1 m/s^2 / v = 25 rad/s.
  const double offset_m = 0.02 * kDt_s;
  const double slope = 0.02 + 25 * offset_m;
  EXPECT_NEAR(largest_m - from_m, slope / 25 * std::exp(25 * offset_m / slope - 1.0), 0.5e-6);
  EXPECT_LT(out_.reference.velocity_m_per_s.norm(), 1e-9);
  EXPECT_NEAR(out_.reference.position_m.x(), from_m, 1e-9) << "and it comes back to where it was last led to";
  EXPECT_FALSE(out_.following);
}

/// The stream's time stands: it will go on where the tool was led last, and not where it has coasted to.
TEST_F(Selector, WhereTheStreamsTimeStandsItComesToRestWhereItWasLedLast) {
  const streaming::StreamSample local = sample();
  for (int n = 0; n < 2000; ++n) play(local, at(0.0, 0.02));
  for (int n = 0; n < 20; ++n) miss();
  EXPECT_NEAR(out_.reference.position_m.x(), 20 * 0.02 * kDt_s, 1e-9);
  double before_m = out_.reference.position_m.x();
  double largest_m = 0.0;
  double longest_m = 0.0;
  for (int n = 0; n < 300; ++n) {
    wait();
    largest_m = std::max(largest_m, out_.reference.position_m.x());
    longest_m = std::max(longest_m, std::abs(out_.reference.position_m.x() - before_m));
    before_m = out_.reference.position_m.x();
  }
  EXPECT_NEAR(out_.reference.position_m.x(), 0.0, 1e-5);
  EXPECT_LT(out_.reference.velocity_m_per_s.norm(), 2e-4);
  EXPECT_LT(largest_m, 0.75e-3) << "20 ms at 20 mm/s, and the way to rest";
  EXPECT_LE(longest_m, 0.02 * kDt_s + 1e-9) << "without a jump";
  EXPECT_FALSE(out_.following);
  play(local, at(0.0, 0.0));
  EXPECT_TRUE(out_.following);
  EXPECT_NEAR(out_.reference.position_m.x(), 0.0, 1e-5);
}

TEST_F(Selector, ItGoesOnWithoutTheLastSamplesAcceleration) {
  const streaming::StreamSample local = sample();
  for (int n = 0; n < 2000; ++n) play(local, at(0.0, 0.02));
  play(local, at(0.0, 0.02, 5.0));
  for (int n = 1; n <= 31; ++n) miss();
  // The 5 mm/s that it would have gained in a step fade, 5e-3 t e^(-100 t).
  const double t_s = 30 * kDt_s;
  EXPECT_NEAR(out_.reference.position_m.x(),
              31 * 0.02 * kDt_s + (2.5e-6 * (1 + 100 * t_s) + 5e-3 * t_s) * std::exp(-100 * t_s), 1e-9);
}

TEST_F(Selector, AStopAndADisengagementEndTheMotionWithoutCoasting) {
  for (const bool stop : {true, false}) {
    selector_ = ReferenceSelector(model(), {}, kDt_s);
    streaming::StreamSample local = sample();
    for (int n = 0; n < 2000; ++n) play(local, at(0.0, 0.02));
    now_.stopped = stop;
    local.engaged = false;
    for (int n = 0; n < 3; ++n) play(local, at(0.0, 0.02));
    EXPECT_LT(out_.reference.velocity_m_per_s.x(), 0.0199) << stop;
    for (int n = 0; n < 2000; ++n) play(local, at(0.0, 0.02));
    EXPECT_LT(out_.reference.velocity_m_per_s.norm(), 1e-9);
    if (!stop) {
      EXPECT_NEAR(out_.reference.position_m.x(), 0.0, 1e-9) << "where it was last led to";
    }
  }
}

TEST_F(Selector, AStopBrakesWithThreeQuartersOfWhatTheRobotMayAndThenGently) {
  const double most = model().limits.acceleration_m_per_s2;
  const streaming::StreamSample local = sample();
  for (int n = 0; n < 2000; ++n) play(local, at(0.0, 0.1));
  now_.stopped = true;
  KinematicState before = out_.reference;
  double hardest = 0.0;
  int steps = 0;
  for (; out_.reference.velocity_m_per_s.x() > 1e-3; ++steps) {
    play(local, at(0.0, 0.1));
    const KinematicState expected = advanced(before, kDt_s);
    ASSERT_LT((out_.reference.position_m - expected.position_m).norm(), 1e-12) << steps;
    ASSERT_LT((out_.reference.velocity_m_per_s - expected.velocity_m_per_s).norm(), 1e-12) << "not sooner than it acts";
    before = out_.reference;
    hardest = std::max(hardest, before.acceleration_m_per_s2.norm());
  }
  EXPECT_NEAR(hardest, 0.75 * most, 1e-9);
  EXPECT_LT(static_cast<double>(steps) * kDt_s, 0.1 / (0.75 * most) + 0.01);
}

TEST_F(Selector, TheReferenceStaysInTheWorkspace) {
  const streaming::StreamSample local = sample();
  const auto settle = [&](const KinematicState& state) {
    for (int n = 0; n < 4000; ++n) play(local, state);
    return out_.reference;
  };
  // 3-4-5: outwards at 0.01 m/s, sidewards at 0.02 m/s.
  const Vec3 outward(0.6, 0.8, 0.0);
  const Vec3 aside(-0.8, 0.6, 0.0);
  KinematicState reference = settle({0.0101 * outward, 0.01 * outward + 0.02 * aside, Vec3(1, 1, 1)});
  EXPECT_LT((reference.position_m - 0.01 * outward).norm(), 1e-12);
  EXPECT_LT((reference.velocity_m_per_s - 0.02 * aside).norm(), 1e-9);
  EXPECT_EQ(reference.acceleration_m_per_s2, Vec3(Vec3::Zero()));
  reference = settle({0.0101 * outward, -0.01 * outward + 0.02 * aside, Vec3(1, 1, 1)});
  EXPECT_LT((reference.velocity_m_per_s - (-0.01 * outward + 0.02 * aside)).norm(), 1e-9)
      << "inwards is fine";
  reference = settle({0.0099 * outward, 0.01 * outward, Vec3(1, 1, 1)});
  EXPECT_LT((reference.position_m - 0.0099 * outward).norm(), 1e-12);
  EXPECT_LT((reference.velocity_m_per_s - 0.01 * outward).norm(), 1e-9);
  for (const double sign : {-1.0, 1.0}) {
    reference = settle({Vec3(1e-3, 0, sign * 5.1e-3), Vec3(0.01, 0.02, 0.03), Vec3(1, 2, 3)});
    EXPECT_LT((reference.position_m - Vec3(1e-3, 0, sign * 5e-3)).norm(), 1e-12);
    EXPECT_LT((reference.velocity_m_per_s - Vec3(0.01, 0.02, 0.0)).norm(), 1e-9);
    EXPECT_LT((reference.acceleration_m_per_s2 - Vec3(1, 2, 0)).norm(), 1e-6);
    reference = settle({Vec3(1e-3, 0, sign * 4.9e-3), Vec3(0.01, 0.02, 0.03), Vec3(1, 2, 3)});
    EXPECT_LT((reference.position_m - Vec3(1e-3, 0, sign * 4.9e-3)).norm(), 1e-12);
    EXPECT_LT((reference.velocity_m_per_s - Vec3(0.01, 0.02, 0.03)).norm(), 1e-9);
  }
  // The radius is that of the plane, and the bounds themselves are within.
  for (const KinematicState& within : {KinematicState{Vec3(9.5e-3, 0, 4e-3), Vec3(0.01, 0, 0), Vec3(1, 1, 1)},
                                       KinematicState{Vec3(0.01, 0, 0), Vec3(0.01, 0, 0), Vec3(1, 1, 1)},
                                       KinematicState{Vec3(0, 0, 5e-3), Vec3(0, 0, 0.01), Vec3(1, 1, 1)},
                                       KinematicState{Vec3(0, 0, -5e-3), Vec3(0, 0, -0.01), Vec3(1, 1, 1)}}) {
    reference = settle(within);
    EXPECT_LT((reference.position_m - within.position_m).norm(), 1e-12) << within.position_m.transpose();
    EXPECT_LT((reference.velocity_m_per_s - within.velocity_m_per_s).norm(), 1e-9)
        << within.position_m.transpose();
    EXPECT_LT((reference.acceleration_m_per_s2 - Vec3(1, 1, 1)).norm(), 1e-6)
        << within.position_m.transpose();
  }
}

}  // namespace
}  // namespace telekerf::slave
