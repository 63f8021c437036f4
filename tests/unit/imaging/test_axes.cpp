// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "slave/vision/imaging/axes_control.h"
#include "slave/vision/imaging/simulated_axes.h"
#include "tests/unit/allocations.h"

namespace telekerf::imaging {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Bench {
  explicit Bench(PerAxis start_m = {10e-3, 8e-3}, double mismatch = 0.2, std::uint64_t seed = 1)
      : axes(default_axes(), start_m, mismatch, seed), control(default_axes(), {}) {}

  void step() {
    axes.write(control.step(axes.read()));
    axes.advance(1e-3);
    ++steps;
  }
  void run(int count) {
    for (int i = 0; i < count; ++i) step();
  }
  bool home() {
    for (int i = 0; i < 20'000 && control.state() != AxesControl::State::kReady; ++i) step();
    return control.state() == AxesControl::State::kReady;
  }
  bool settle(int most = 5'000) {
    const int until = steps + most;
    do step();
    while (!control.settled() && steps < until);
    return control.settled();
  }

  SimulatedAxes axes;
  AxesControl control;
  int steps = 0;
};

TEST(Axes, HomeFromAnywhere) {
  for (const PerAxis& start : {PerAxis{0.07, 0.029}, PerAxis{1e-3, 1e-3}, PerAxis{0.04, 2e-3}}) {
    Bench bench(start);
    ASSERT_TRUE(bench.home());
    ASSERT_TRUE(bench.settle());
    for (const std::size_t axis : {kMagnification, kFocus})
      EXPECT_NEAR(bench.control.position_m(axis), bench.axes.motor_m(axis), 30e-6) << start[axis];
  }
}

TEST(Axes, HomeFromBelowTheSwitchFindTheSameZero) {
  Bench bench({-0.3e-3, -0.2e-3});
  ASSERT_TRUE(bench.home());
  bench.settle();
  for (const std::size_t axis : {kMagnification, kFocus})
    EXPECT_NEAR(bench.control.position_m(axis), bench.axes.motor_m(axis), 30e-6);
}

TEST(Axes, GoWhereTheyAreSentWhateverTheMotorsAre) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Bench bench({5e-3, 5e-3}, 0.3, seed);
    ASSERT_TRUE(bench.home());
    bench.control.move_to(kMagnification, 0.06);
    bench.control.move_to(kFocus, 0.02);
    const int from = bench.steps;
    ASSERT_TRUE(bench.settle()) << seed;
    EXPECT_NEAR(bench.control.position_m(kMagnification), 0.06, 6e-6);
    EXPECT_NEAR(bench.control.position_m(kFocus), 0.02, 6e-6);
    EXPECT_EQ(bench.control.goal_m(kFocus), 0.02);
    EXPECT_LT(bench.steps - from, 2500);
  }
}

TEST(Axes, DoNotExceedTheirSpeedAndBarelyOvershoot) {
  Bench bench;
  ASSERT_TRUE(bench.home());
  bench.control.move_to(kFocus, 0.025);
  double fastest = 0.0;
  double farthest = 0.0;
  for (int i = 0; i < 2000; ++i) {
    bench.step();
    fastest = std::max(fastest, std::abs(bench.axes.speed_m_per_s(kFocus)));
    farthest = std::max(farthest, bench.axes.motor_m(kFocus));
  }
  EXPECT_GT(fastest, 0.9 * default_axes()[kFocus].speed_m_per_s);
  EXPECT_LT(fastest, 1.1 * default_axes()[kFocus].speed_m_per_s);
  EXPECT_LT(farthest, 0.025 + 50e-6);
}

TEST(Axes, ApproachedFromBelowTheOpticsAreWhereTheyWere) {
  Bench bench;
  ASSERT_TRUE(bench.home());
  bench.control.approach(kFocus, 0.015);
  ASSERT_TRUE(bench.settle());
  const double first = bench.axes.optics_m().focus_m;
  for (const double away : {0.019, 0.0151, 0.011, 0.0149, 0.0152}) {
    bench.control.approach(kFocus, away);
    bench.settle();
    bench.control.approach(kFocus, 0.015);
    ASSERT_TRUE(bench.settle());
    EXPECT_NEAR(bench.axes.optics_m().focus_m, first, 8e-6) << away;
  }
  // From above they are a whole play off.
  bench.control.approach(kFocus, 0.016);
  bench.settle();
  bench.control.move_to(kFocus, 0.015);
  ASSERT_TRUE(bench.settle());
  EXPECT_NEAR(bench.axes.optics_m().focus_m - first, default_axes()[kFocus].backlash_m, 15e-6);
}

TEST(Axes, StayOffTheEnds) {
  Bench bench;
  ASSERT_TRUE(bench.home());
  for (const double goal : {-1.0, 1.0}) {
    bench.control.approach(kFocus, goal);
    bench.settle();
    EXPECT_NEAR(bench.control.position_m(kFocus),
                goal < 0.0 ? bench.control.lowest_m() : bench.control.highest_m(kFocus), 1e-5);
  }
  EXPECT_DOUBLE_EQ(bench.control.highest_m(kMagnification), 0.08 - AxesControl::kMargin_m);
  for (const double velocity : {0.03, -0.03}) {
    bench.control.drive(kFocus, velocity);
    bench.run(3000);
    EXPECT_NEAR(bench.control.position_m(kFocus),
                velocity < 0.0 ? bench.control.lowest_m() : bench.control.highest_m(kFocus), 50e-6);
  }
}

TEST(Axes, FollowAVelocity) {
  Bench bench;
  ASSERT_TRUE(bench.home());
  bench.control.move_to(kFocus, 5e-3);
  bench.settle();
  for (const double velocity : {4e-3, -2e-3}) {
    bench.control.drive(kFocus, velocity);
    bench.run(400);
    EXPECT_FALSE(bench.control.settled(kFocus));
    EXPECT_NEAR(bench.control.velocity_m_per_s(kFocus), velocity,
                0.6e-3);  // half a count a period is 0.25e-3
    EXPECT_NEAR(bench.axes.speed_m_per_s(kFocus), velocity, 0.1 * std::abs(velocity));
  }
  bench.control.drive(kFocus, kNan);
  bench.run(300);
  EXPECT_NEAR(bench.axes.speed_m_per_s(kFocus), 0.0, 1e-4);
  bench.control.drive(kFocus, 10.0);  // faster than it may
  bench.run(200);
  EXPECT_LT(bench.axes.speed_m_per_s(kFocus), 1.1 * default_axes()[kFocus].speed_m_per_s);
}

TEST(Axes, BridgeMissingReadingsAndAreLostAfterTooMany) {
  Bench bench;
  ASSERT_TRUE(bench.home());
  bench.control.move_to(kFocus, 0.02);
  for (int i = 0; i < 3000; ++i) {  // every third is missing
    AxesReading reading = bench.axes.read();
    reading.valid = i % 3 != 0;
    bench.axes.write(bench.control.step(reading));
    bench.axes.advance(1e-3);
  }
  EXPECT_NEAR(bench.axes.motor_m(kFocus), 0.02, 50e-6);
  AxesReading none;
  for (int i = 0; i < AxesControl::kMaxMissing; ++i) bench.control.step(none);
  EXPECT_EQ(bench.control.state(), AxesControl::State::kReady);
  EXPECT_EQ(bench.control.step(none), PerAxis{});
  EXPECT_EQ(bench.control.state(), AxesControl::State::kLost);
  EXPECT_FALSE(bench.control.settled());
}

TEST(Axes, WhoseDeviceHasCountedNothingNewAreLost) {
  // It answers, but its encoders are read no more: what it says of them is old.
  Bench bench;
  ASSERT_TRUE(bench.home());
  bench.control.move_to(kFocus, 0.02);
  bench.run(50);
  const AxesReading frozen = bench.axes.read();
  bench.control.step(frozen);
  for (int i = 0; i < AxesControl::kMaxMissing; ++i) bench.control.step(frozen);
  EXPECT_EQ(bench.control.state(), AxesControl::State::kReady);
  EXPECT_EQ(bench.control.step(frozen), PerAxis{});
  EXPECT_EQ(bench.control.state(), AxesControl::State::kLost);
}

TEST(Axes, AreReadEveryOtherStepIfTheirDeviceIsSlower) {
  Bench bench;
  AxesReading reading;
  const auto half_as_often = [&](int count) {
    for (int i = 0; i < count; ++i) {
      if (i % 2 == 0) reading = bench.axes.read();
      bench.axes.write(bench.control.step(reading));
      bench.axes.advance(1e-3);
    }
  };
  half_as_often(4000);
  ASSERT_EQ(bench.control.state(), AxesControl::State::kReady);
  bench.control.move_to(kFocus, 0.02);
  half_as_often(3000);
  EXPECT_NEAR(bench.axes.motor_m(kFocus), 0.02, 60e-6);
}

TEST(Axes, APlaceThatIsNoNumberIsNone) {
  Bench bench;
  ASSERT_TRUE(bench.home());
  bench.control.move_to(kFocus, 0.012);
  ASSERT_TRUE(bench.settle());
  for (const double place : {kNan, std::numeric_limits<double>::infinity()}) {
    bench.control.move_to(kFocus, place);
    bench.control.approach(kFocus, place);
    EXPECT_EQ(bench.control.goal_m(kFocus), 0.012);
  }
  // Nor is a reading that is none.
  AxesReading reading = bench.axes.read();
  reading.encoders_m[kMagnification] = kNan;
  const PerAxis currents = bench.control.step(reading);
  EXPECT_TRUE(std::isfinite(currents[kMagnification]) && std::isfinite(currents[kFocus]));
  EXPECT_NEAR(bench.control.position_m(kFocus), 0.012, 20e-6);
}

TEST(Axes, PassingAPlaceIsNotArriving) {
  Bench bench;
  ASSERT_TRUE(bench.home());
  bench.control.move_to(kFocus, 0.015);
  ASSERT_TRUE(bench.settle());
  for (const double velocity : {0.01, -0.01}) {
    bench.control.drive(kFocus, velocity);
    bench.run(200);
    bench.control.move_to(kFocus, bench.control.position_m(kFocus));
    EXPECT_FALSE(bench.control.settled(kFocus)) << velocity;
    EXPECT_TRUE(bench.settle());
  }
}

TEST(Axes, LookForTheirSwitchNoFasterThanTheyCanStop) {
  AxisModel axis;
  EXPECT_EQ(AxesControl::homing_m_per_s(axis), AxesControl::kHoming_m_per_s);
  axis.speed_m_per_s = 2e-3;
  EXPECT_EQ(AxesControl::homing_m_per_s(axis), 2e-3);
  axis.acceleration_m_per_s2 = 2e-3;
  EXPECT_NEAR(AxesControl::homing_m_per_s(axis), 1e-3, 1e-12);  // stops within half a margin of 0.5 mm
  AxesModel model;
  EXPECT_DOUBLE_EQ(AxesControl::longest_way_s(model), 3.0);
  model[kMagnification].travel_m = 1.0;
  EXPECT_DOUBLE_EQ(AxesControl::longest_way_s(model), 100.0);
  model[kFocus] = axis;
  model[kFocus].travel_m = 0.2;
  EXPECT_NEAR(AxesControl::longest_way_s(model), 200.0, 1e-9);

  AxesModel slow = default_axes();
  for (AxisModel& one : slow) one.speed_m_per_s = 3e-3;
  SimulatedAxes axes(slow, {5e-3, 5e-3}, 0.0, 1);
  AxesControl control(slow, {});
  double fastest = 0.0;
  for (int i = 0; i < 4000 && control.state() != AxesControl::State::kReady; ++i) {
    axes.write(control.step(axes.read()));
    axes.advance(1e-3);
    fastest = std::max(fastest, std::abs(axes.speed_m_per_s(kFocus)));
  }
  EXPECT_EQ(control.state(), AxesControl::State::kReady);
  EXPECT_LT(fastest, 1.15 * 3e-3);
}

TEST(Axes, AreGivenNoCurrentBeforeTheFirstReading) {
  AxesControl control(default_axes(), {});
  EXPECT_EQ(control.step({}), PerAxis{});
  EXPECT_EQ(control.state(), AxesControl::State::kHoming);
  // The first reading is where they stand, whatever it is.
  AxesReading far;
  far.encoders_m = {0.5, -0.3};
  far.valid = true;
  far.tick = 1;
  control.step(far);
  EXPECT_NEAR(control.position_m(kMagnification), 0.5, 1e-6);
  EXPECT_NEAR(control.velocity_m_per_s(kMagnification), 0.0, 1e-6);
}

TEST(Axes, AreNeverGivenMoreThanTheirPeakForce) {
  Bench bench({0.07, 0.029}, 0.3, 4);
  const AxesModel model = default_axes();
  for (int i = 0; i < 6000; ++i) {
    const PerAxis currents = bench.control.step(bench.axes.read());
    for (const std::size_t axis : {kMagnification, kFocus})
      ASSERT_LE(std::abs(currents[axis]),
                model[axis].peak_force_n / model[axis].force_constant_n_per_a + 1e-12);
    bench.axes.write(currents);
    bench.axes.advance(1e-3);
    if (i % 700 == 0) bench.control.move_to(kFocus, i % 1400 == 0 ? 0.028 : 0.002);
  }
}

TEST(Axes, AStepAllocatesNothing) {
  Bench bench;
  ASSERT_TRUE(bench.home());
  bench.control.approach(kFocus, 0.012);
  const std::uint64_t before = testing::allocations();
  bench.run(500);
  EXPECT_EQ(testing::allocations(), before);
}

TEST(SimulatedAxes, StickUnderLessThanTheirFriction) {
  SimulatedAxes axes(default_axes(), {0.01, 0.01}, 0.0, 1);
  axes.write({0.2, 0.1});  // 8 N of 12, 2 N of 3
  axes.advance(0.5);
  EXPECT_LT(axes.motor_m(kFocus), 0.01 + 0.5e-3);
  EXPECT_LT(axes.speed_m_per_s(kFocus), 1e-3);
  axes.write({0.6, 0.3});
  axes.advance(0.05);
  EXPECT_GT(axes.speed_m_per_s(kFocus), 5e-3);
}

TEST(SimulatedAxes, RunAsFastAsTheirFrictionLets) {
  SimulatedAxes axes(default_axes(), {0.01, 0.005}, 0.0, 1);
  axes.write({0.33, 0.18});  // 13.2 N of which 12 are dry friction, 3.6 N of which 3
  axes.advance(0.5);
  EXPECT_NEAR(axes.speed_m_per_s(kMagnification), 1.2 / 60.0, 1e-4);
  EXPECT_NEAR(axes.speed_m_per_s(kFocus), 0.6 / 30.0, 1e-4);
}

TEST(SimulatedAxes, AreHeldByTheirEndStopsAndClipTheCurrent) {
  SimulatedAxes axes(default_axes(), {0.079, 0.029}, 0.0, 1);
  axes.write({100.0, 100.0});
  axes.advance(1.0);
  EXPECT_LT(axes.motor_m(kFocus), 0.03 + 0.2e-3);
  EXPECT_NEAR(axes.speed_m_per_s(kFocus), 0.0, 1e-6);
  axes.write({-100.0, -100.0});
  axes.advance(3.0);
  EXPECT_NEAR(axes.motor_m(kFocus), SimulatedAxes::kLowerStop_m, 0.2e-3);
  EXPECT_TRUE(axes.read().at_lower_end[kFocus]);
}

TEST(SimulatedAxes, EncodersCountFromWhereTheyWereSwitchedOn) {
  SimulatedAxes axes(default_axes(), {0.02, 0.01}, 0.0, 1);
  EXPECT_EQ(axes.read().encoders_m, PerAxis{});
  axes.write({1.0, 1.0});
  axes.advance(0.1);
  const AxesReading reading = axes.read();
  EXPECT_TRUE(reading.valid);
  EXPECT_EQ(reading.tick, 2U);
  EXPECT_NEAR(reading.encoders_m[kFocus], axes.motor_m(kFocus) - 0.01, SimulatedAxes::kEncoder_m);
  for (int i = 0; i < 50; ++i) {  // rounded, not cut off
    axes.advance(1e-3);
    ASSERT_LE(std::abs(axes.read().encoders_m[kFocus] - (axes.motor_m(kFocus) - 0.01)),
              0.5001 * SimulatedAxes::kEncoder_m);
  }
  EXPECT_FALSE(reading.at_lower_end[kFocus]);
}

}  // namespace
}  // namespace telekerf::imaging
