// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "slave/machining/even_burn.h"
#include "slave/machining/timed_path.h"

namespace telekerf::machining {
namespace {

const geometry::Polyline kSquare{{{0, 0}, {10e-3, 0}, {10e-3, 10e-3}, {0, 10e-3}}, true};

TEST(TimedPath, ConstantSpeedWithTheBeamOnAndRestAtBothEnds) {
  const auto plan = make_timed_path(kSquare, TimedPathSettings{});
  ASSERT_TRUE(plan) << plan.error();
  EXPECT_NEAR(plan->mean_speed_m_per_s, 8e-3, 8e-6);
  EXPECT_NEAR(plan->cut_s, plan->path.length_m() / 8e-3, 0.05);
  const Trajectory& trajectory = plan->trajectory;
  EXPECT_EQ(trajectory[0].speed_m_per_s, 0.0);
  EXPECT_NEAR(trajectory[trajectory.size() - 1].speed_m_per_s, 0.0, 1e-6);
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (trajectory[i].beam) {
      EXPECT_NEAR(trajectory[i].speed_m_per_s, 8e-3, 8e-6) << i;
    }
    if (!trajectory[i].beam) {
      EXPECT_EQ(trajectory[i].power, 0.0);
    }
  }
}

TEST(TimedPath, WhatWouldTakeHoursIsRefused) {
  TimedPathSettings settings;
  settings.speed_m_per_s = 1e-7;
  settings.ramp_m_per_s2 = 1e-4;
  const auto plan = make_timed_path(kSquare, settings);
  ASSERT_FALSE(plan);
  EXPECT_EQ(plan.error(), "the path takes too long at this speed");
}

TEST(TimedPath, VelocityAndAccelerationAreTheDerivativesOfThePosition) {
  for (const CornerPolicy corner : {CornerPolicy::kRounded, CornerPolicy::kSlow}) {
    TimedPathSettings settings;
    settings.corner = corner;
    const auto plan = make_timed_path(kSquare, settings);
    ASSERT_TRUE(plan);
    const Trajectory& t = plan->trajectory;
    const double dt = plan->period_s;
    double worst = 0.0;
    for (std::size_t i = 2; i + 2 < t.size(); ++i) {
      EXPECT_LT(((t[i + 1].position_m - t[i - 1].position_m) / (2 * dt) - t[i].velocity_m_per_s).norm(),
                2e-4);
      // Fourth order: a corner is passed within a dozen ticks, so the second order's own error is 0.17 m/s^2.
      const Vec3 slope = (8.0 * (t[i + 1].velocity_m_per_s - t[i - 1].velocity_m_per_s) -
                          (t[i + 2].velocity_m_per_s - t[i - 2].velocity_m_per_s)) /
                         (12 * dt);
      worst = std::max(worst, (slope - t[i].acceleration_m_per_s2).norm());
    }
    EXPECT_LT(worst, 0.05);
  }
}

TEST(TimedPath, SlowCornersKeepTheAccelerationAndThePowerFollowsTheSpeed) {
  TimedPathSettings settings;
  settings.corner = CornerPolicy::kSlow;
  const auto plan = make_timed_path(kSquare, settings);
  ASSERT_TRUE(plan);
  EXPECT_LT(plan->slowest_m_per_s, 0.8 * settings.speed_m_per_s);
  double worst = 0.0;
  for (std::size_t i = 0; i < plan->trajectory.size(); ++i) {
    const Reference& r = plan->trajectory[i];
    if (!r.beam || r.arc_length_m < 1e-3 || r.arc_length_m > plan->path.length_m() - 1e-3) continue;
    worst = std::max(worst, r.acceleration_m_per_s2.norm());
    const double power = r.speed_m_per_s / settings.speed_m_per_s;
    EXPECT_LE(r.power, 1.25 * power + 1e-9);
    // Two spot radii from a corner the beam meets no other leg.
    const double to_corner = std::abs(std::remainder(r.arc_length_m, plan->path.length_m() / 4));
    if (to_corner > 0.2e-3) {
      EXPECT_NEAR(r.power, power, 0.01 * power) << r.arc_length_m;
    }
  }
  EXPECT_LT(worst, 1.5 * settings.slow_acceleration_m_per_s2);
}

// The speed is smoothed in time, so that the slow place is made longer than the bend.
TEST(TimedPath, SlowCornersArePassedWithWhatTheyMayHaveAcross) {
  for (const double speed : {8e-3, 20e-3}) {
    TimedPathSettings settings;
    settings.corner = CornerPolicy::kSlow;
    settings.speed_m_per_s = speed;
    const auto plan = make_timed_path(kSquare, settings);
    ASSERT_TRUE(plan);
    double across = 0.0;
    for (std::size_t i = 0; i < plan->trajectory.size(); ++i) {
      const Reference& r = plan->trajectory[i];
      across = std::max(across, r.speed_m_per_s * r.speed_m_per_s * r.tangent_s.norm());
    }
    EXPECT_NEAR(across, 0.25004, 1e-4) << speed;
    EXPECT_NEAR(plan->slowest_m_per_s, 1.98e-3, 0.01e-3) << speed;
  }
}

TEST(TimedPath, TheMachinesAccelerationIsNeverPassedHoweverFast) {
  for (const CornerPolicy corner : {CornerPolicy::kExact, CornerPolicy::kRounded, CornerPolicy::kSlow}) {
    TimedPathSettings settings;
    settings.corner = corner;
    settings.speed_m_per_s = 0.1;
    const auto plan = make_timed_path(kSquare, settings);
    ASSERT_TRUE(plan);
    for (std::size_t i = 0; i < plan->trajectory.size(); ++i) {
      ASSERT_LT(plan->trajectory[i].acceleration_m_per_s2.norm(), 1.25 * settings.max_acceleration_m_per_s2)
          << i;
    }
  }
}

TEST(TimedPath, NorIsItAtAnAcuteTip) {
  // 15 degrees: the rounding is shorter than a sample's way.
  const geometry::Polyline tip{{{0, 0}, {5e-3, 0}, {0.17e-3, 1.294e-3}}, true};
  for (const double speed : {8e-3, 50e-3}) {
    TimedPathSettings settings;
    settings.speed_m_per_s = speed;
    const auto plan = make_timed_path(tip, settings);
    ASSERT_TRUE(plan);
    const double rate = settings.control_hz;
    for (std::size_t i = 1; i + 1 < plan->trajectory.size(); ++i) {
      const Vec3 moved = plan->trajectory[i + 1].position_m - 2.0 * plan->trajectory[i].position_m +
                         plan->trajectory[i - 1].position_m;
      ASSERT_LT(moved.norm() * rate * rate, settings.max_acceleration_m_per_s2) << i;
      ASSERT_LT(plan->trajectory[i].acceleration_m_per_s2.norm(), 1.25 * settings.max_acceleration_m_per_s2)
          << i;
    }
  }
}

TEST(TimedPath, TheSeamOfAClosedContourGetsAsMuchEnergyAsTheRest) {
  const auto plan = make_timed_path(kSquare, TimedPathSettings{});
  ASSERT_TRUE(plan);
  const double length = plan->path.length_m();
  std::vector<double> energy(20, 0.0);  // bins of 10 um from the start
  for (std::size_t i = 0; i < plan->trajectory.size(); ++i) {
    const Reference& r = plan->trajectory[i];
    const double place = std::fmod(r.arc_length_m + length, length);
    if (r.beam && place < 0.2e-3) energy[static_cast<std::size_t>(place / 10e-6)] += r.power;
  }
  for (const double e : energy) EXPECT_NEAR(e, energy.back(), 0.5);  // ticks of 3.3 um in bins of 10
}

TEST(TimedPath, AnAcuteTipGetsNoMoreEnergyThanItsLegs) {
  // 30 degrees: the spot covers both legs for more than 0.1 mm.
  const geometry::Polyline tip{{{0, 0}, {5e-3, 0}, {0.67e-3, 2.5e-3}}, false};
  TimedPathSettings settings;
  settings.corner = CornerPolicy::kSlow;
  const auto plan = make_timed_path(tip, settings);
  ASSERT_TRUE(plan);
  const double w = settings.spot_radius_m;
  const auto dose_at = [&](double arc_m) {
    const Vec2 place = plan->path.at(arc_m).position_m.head<2>();
    double dose = 0.0;
    for (std::size_t i = 0; i < plan->trajectory.size(); ++i) {
      const Reference& r = plan->trajectory[i];
      dose += r.power * std::exp(-2.0 * (r.position_m.head<2>() - place).squaredNorm() / (w * w));
    }
    return dose;
  };
  const double straight = dose_at(2e-3);
  for (double s = 4.6e-3; s < 5.4e-3; s += 10e-6)
    EXPECT_NEAR(dose_at(s) / straight, 1.0, 0.12) << s;  // 1.46 without the plan's shares
}

TEST(TimedPath, RefusesWhatIsSmallerThanTheBeam) {
  geometry::Polyline small = kSquare;
  for (Vec2& p : small.points_m) p *= 50e-6 / geometry::bounding_box(kSquare.points_m).size().maxCoeff();
  const auto plan = make_timed_path(small, TimedPathSettings{});
  ASSERT_FALSE(plan);
  EXPECT_NE(plan.error().find("--width-mm"), std::string::npos) << plan.error();
}

TEST(TimedPath, KeepsWithinAMachinesLimits) {
  TimedPathSettings settings;
  settings.speed_m_per_s = 20e-3;
  settings.keep_within({.velocity_m_per_s = 0.025, .acceleration_m_per_s2 = 0.5});
  const auto plan = make_timed_path(kSquare, settings);
  ASSERT_TRUE(plan) << plan.error();
  double most = 0.0;
  for (std::size_t i = 0; i < plan->trajectory.size(); ++i)
    most = std::max(most, plan->trajectory[i].acceleration_m_per_s2.norm());
  EXPECT_LT(most, 0.5);
  EXPECT_GT(most, 0.1) << "and uses them";
  settings.keep_within({.velocity_m_per_s = 0.02, .acceleration_m_per_s2 = 0.5});
  const auto faster = make_timed_path(kSquare, settings);
  ASSERT_FALSE(faster);
  EXPECT_NE(faster.error().find("20 mm/s is more than the 18 mm/s"), std::string::npos) << faster.error();
}

// From rest to rest: room to come to speed, to smooth and to settle before the beam comes on, and as much
// behind.
TEST(TimedPath, TheWayNeverGoesBackAndHasItsRunUpAndRunOut) {
  for (const CornerPolicy corner : {CornerPolicy::kRounded, CornerPolicy::kSlow}) {
    for (const bool closed : {true, false}) {
      for (const double speed : {8e-3, 50e-3}) {
        TimedPathSettings settings;
        settings.corner = corner;
        settings.speed_m_per_s = speed;
        const auto plan = make_timed_path(geometry::Polyline{kSquare.points_m, closed}, settings);
        ASSERT_TRUE(plan);
        const Trajectory& t = plan->trajectory;
        const double run_up = speed * speed / 4.0 + 1.5 * speed * 0.012 + std::min(2e-3, 0.15 * speed);
        const double cut_end = plan->path.length_m() + (closed ? 0.2e-3 : 0.0);
        EXPECT_NEAR(t[0].arc_length_m, -run_up, 1e-12);
        EXPECT_NEAR(t[t.size() - 1].arc_length_m, cut_end + run_up, 1e-12);
        std::size_t lit = 0;
        double slowest = speed;
        for (std::size_t i = 0; i < t.size(); ++i) {
          if (i > 0) {
            ASSERT_GE(t[i].arc_length_m, t[i - 1].arc_length_m) << i;
          }
          ASSERT_EQ(t[i].beam, t[i].arc_length_m >= 0.0 && t[i].arc_length_m <= cut_end) << i;
          ASSERT_LE(t[i].speed_m_per_s, speed * (1.0 + 1e-9));
          ASSERT_LE(t[i].speed_rate_m_per_s2, 2.0 * (1.0 + 1e-6));
          ASSERT_GE(t[i].speed_rate_m_per_s2, -2.0 * (1.0 + 1e-2));
          if (!t[i].beam) continue;
          ++lit;
          slowest = std::min(slowest, t[i].speed_m_per_s);
        }
        EXPECT_NEAR(plan->cut_s, static_cast<double>(lit) / 2400.0, 1e-12);
        EXPECT_NEAR(plan->mean_speed_m_per_s, cut_end / plan->cut_s, 1e-12);
        EXPECT_EQ(plan->slowest_m_per_s, slowest);
        EXPECT_NEAR(plan->time_s(), static_cast<double>(t.size()) / 2400.0, 1e-12);
      }
    }
  }
}

TEST(EvenBurn, AStraightStrokeIsBurntFullyAndAnOverlapFadesOver) {
  const auto stroke = Path::through(geometry::Polyline{{{0, 0}, {3e-3, 0}}, false}, {});
  ASSERT_TRUE(stroke);
  const EvenBurn even(*stroke, stroke->length_m(), 30e-6, 0.0);
  for (double s = 0.0; s < 3e-3; s += 50e-6) EXPECT_NEAR(even.fraction(s), 1.0, 1e-4) << s;
  geometry::Polyline ring{{}, true};
  for (int i = 0; i < 3000; ++i)
    ring.points_m.emplace_back(3e-3 * std::cos(i * M_PI / 1500), 3e-3 * std::sin(i * M_PI / 1500));
  const auto path = Path::through(ring, {});
  ASSERT_TRUE(path);
  const double length = path->length_m(), overlap = 0.2e-3;
  const EvenBurn round(*path, length + overlap, 30e-6, overlap);
  EXPECT_NEAR(round.fraction(0.0), 0.0, 1e-9);
  EXPECT_NEAR(round.fraction(length + overlap), 0.0, 0.05);
  for (double s = 10e-6; s < overlap; s += 10e-6)
    EXPECT_NEAR(round.fraction(s) + round.fraction(length + s), 1.0, 0.02) << s << " start and end together";
  for (double s = 0.5e-3; s < length - 0.5e-3; s += 0.1e-3) EXPECT_NEAR(round.fraction(s), 1.0, 0.002) << s;
}

TEST(EvenBurn, NoPlaceGetsMoreThanAQuarterMoreThanWasPlanned) {
  geometry::Polyline zigzag{{}, false};  // legs of 0.3 mm, a spot radius apart
  for (int i = 0; i < 20; ++i) zigzag.points_m.emplace_back(30e-6 * i, i % 2 == 0 ? 0.0 : 0.3e-3);
  const auto path = Path::through(zigzag, {.tolerance_m = 0.0});
  ASSERT_TRUE(path);
  const EvenBurn even(*path, path->length_m(), 30e-6, 0.0);
  double most = 0.0, least = 1.0;
  for (double s = 0.0; s < path->length_m(); s += 1e-6) {
    most = std::max(most, even.fraction(s));
    least = std::min(least, even.fraction(s));
  }
  EXPECT_NEAR(most, 1.25, 1e-9) << "the outermost corners";
  EXPECT_LT(least, 0.5) << "and in between little";
}

TEST(TimedPath, CornersAreRoundedByWhatThePolicySays) {
  TimedPathSettings settings;
  settings.tolerance_m = 25e-6;
  settings.corner = CornerPolicy::kExact;
  EXPECT_EQ(path_settings(settings).tolerance_m, 0.0);
  settings.corner = CornerPolicy::kRounded;
  EXPECT_EQ(path_settings(settings).tolerance_m, 25e-6);
  settings.corner = CornerPolicy::kSlow;
  EXPECT_EQ(path_settings(settings).tolerance_m, 10e-6);
  settings.tolerance_m = 4e-6;
  EXPECT_EQ(path_settings(settings).tolerance_m, 4e-6);
}

TEST(TimedPath, ItsSettingsHaveTheseDefaults) {
  const TimedPathSettings settings;
  EXPECT_EQ(settings.control_hz, 2400.0);
  EXPECT_EQ(settings.speed_m_per_s, 8e-3);
  EXPECT_EQ(settings.corner, CornerPolicy::kRounded);
  EXPECT_EQ(settings.tolerance_m, 10e-6);
  EXPECT_EQ(settings.slow_acceleration_m_per_s2, 0.25);
  EXPECT_EQ(settings.max_acceleration_m_per_s2, 10.0);
  EXPECT_EQ(settings.max_speed_m_per_s, 0.3);
  EXPECT_EQ(settings.ramp_m_per_s2, 2.0);
  EXPECT_EQ(settings.smoothing_s, 0.012);
  EXPECT_EQ(settings.settle_s, 0.15);
  EXPECT_EQ(settings.settle_m, 2e-3);
  EXPECT_EQ(settings.overlap_m, 0.2e-3);
  EXPECT_EQ(settings.spot_radius_m, 30e-6);
  EXPECT_EQ(PathSettings{}.tolerance_m, 15e-6);
  EXPECT_EQ(PathSettings{}.min_smoothing_m, 12e-6);
  EXPECT_EQ(PathSettings{}.max_smoothing_m, 40e-6);
  // What nobody has planned neither moves nor burns.
  const Reference nothing;
  EXPECT_FALSE(nothing.beam);
  for (const double value :
       {nothing.speed_m_per_s, nothing.speed_rate_m_per_s2, nothing.arc_length_m, nothing.power})
    EXPECT_EQ(value, 0.0);
}

TEST(TimedPath, ASpeedAtTheMachinesLimitIsTakenAndASizeOfTheBeamsToo) {
  TimedPathSettings settings;
  settings.max_speed_m_per_s = settings.speed_m_per_s = 20e-3;
  EXPECT_TRUE(make_timed_path(kSquare, settings));
  settings.speed_m_per_s = std::nextafter(20e-3, 1.0);
  EXPECT_FALSE(make_timed_path(kSquare, settings));
  settings.speed_m_per_s = 8e-3;
  geometry::Polyline small{{{0, 0}, {2.0 * settings.spot_radius_m, 0}}, false};
  EXPECT_TRUE(make_timed_path(small, settings));
  small.points_m[1].x() = std::nextafter(small.points_m[1].x(), 0.0);
  const auto refused = make_timed_path(small, settings);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(),
            "the contour is 0.06 mm across, less than the beam's 0.06 mm; use a larger --width-mm");
  EXPECT_FALSE(make_timed_path(geometry::Polyline{}, settings)) << "of no points, in a sentence";
}

TEST(TimedPath, RefusesASpeedOfZero) {
  TimedPathSettings settings;
  settings.speed_m_per_s = 0.0;
  EXPECT_FALSE(make_timed_path(kSquare, settings));
}

TEST(Trajectory, ReadAheadStopsAtTheEnd) {
  const auto plan = make_timed_path(kSquare, TimedPathSettings{});
  const Reference end = plan->trajectory.at(1e9);
  EXPECT_EQ(end.velocity_m_per_s.norm(), 0.0);
  EXPECT_EQ(end.position_m, plan->trajectory[plan->trajectory.size() - 1].position_m);
}

}  // namespace
}  // namespace telekerf::machining
