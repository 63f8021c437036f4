// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/robot/drivers/simulated_robot.h"
#include "slave/machining/job_executor.h"

namespace telekerf::machining {
namespace {

geometry::Polyline square(double side_m) {
  const double h = side_m / 2;
  return {{{-h, -h}, {h, -h}, {h, h}, {-h, h}}, true};
}

TEST(Job, WhatLiesInsideIsCutFirstAndEverythingIsOneSteadyMotion) {
  const auto job = make_job({square(10e-3), square(4e-3)}, JobSettings{});
  ASSERT_TRUE(job) << job.error();
  EXPECT_EQ(job->order, (std::vector<std::size_t>{1, 0}));
  ASSERT_EQ(job->phases.size(), job->trajectory.size());
  for (std::size_t i = 1; i < job->trajectory.size(); ++i) {
    const Reference& a = job->trajectory[i - 1];
    const Reference& b = job->trajectory[i];
    ASSERT_LT((b.position_m - a.position_m).norm(), 31e-3 * job->period_s) << i;
    ASSERT_LT((b.velocity_m_per_s - a.velocity_m_per_s).norm(), 10.0 * job->period_s) << i;
    if (b.beam) {
      EXPECT_EQ(job->phases[i], JobPhase::kCut);
    }
  }
  EXPECT_LT(job->trajectory[job->trajectory.size() - 1].position_m.norm(), 1e-9);
}

TEST(Job, KeepsASlowMachinesLimitsOnItsWaysToo) {
  JobSettings settings;
  settings.plan.keep_within({.velocity_m_per_s = 10e-3, .acceleration_m_per_s2 = 0.4});
  const auto job = make_job({square(10e-3), square(4e-3)}, settings);
  ASSERT_TRUE(job) << job.error();
  for (std::size_t i = 0; i < job->trajectory.size(); ++i) {
    ASSERT_LT(job->trajectory[i].velocity_m_per_s.norm(), 10e-3 * (1.0 + 1e-9)) << i;
    ASSERT_LT(job->trajectory[i].acceleration_m_per_s2.norm(), 0.4) << i;
  }
}

TEST(Job, KerfIsTakenOffTheHoleAndAddedToThePiece) {
  JobSettings settings;
  settings.kerf_m = 0.2e-3;
  const auto job = make_job({square(10e-3), square(4e-3)}, settings);
  ASSERT_TRUE(job) << job.error();
  EXPECT_NEAR(job->plans[0].path.length_m(), 4 * 3.8e-3, 0.2e-3);
  EXPECT_NEAR(job->plans[1].path.length_m(), 4 * 10.2e-3, 0.3e-3);
}

TEST(Job, ChosenContoursKeepTheirNumbersAndAHoleChosenAloneIsStillOne) {
  JobSettings settings;
  settings.kerf_m = 0.2e-3;
  settings.select = {2, 1, 2};
  const auto two = make_job({square(10e-3), square(7e-3), square(4e-3)}, settings);
  ASSERT_TRUE(two) << two.error();
  EXPECT_EQ(two->order, (std::vector<std::size_t>{2, 1}));
  settings.select = {1};
  const auto hole = make_job({square(10e-3), square(7e-3), square(4e-3)}, settings);
  ASSERT_TRUE(hole) << hole.error();
  EXPECT_EQ(hole->order, (std::vector<std::size_t>{1}));
  EXPECT_NEAR(geometry::length_m(hole->lines[0]), 4 * 6.8e-3, 1e-6);
  for (const double number : {3.0, 0.5}) {
    settings.select = {number};
    const auto none = make_job({square(10e-3), square(7e-3), square(4e-3)}, settings);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error(),
              fmt::format("--select {:g}: there are the contours 0 to 2; --dry-run lists them", number));
  }
}

TEST(Job, ASlotThatTheBeamCannotEnterIsSaid) {
  geometry::Polyline plate = square(10e-3);
  plate.points_m.insert(plate.points_m.begin() + 1,
                        {{-0.05e-3, -5e-3}, {-0.05e-3, 0}, {0.05e-3, 0}, {0.05e-3, -5e-3}});
  JobSettings settings;
  settings.kerf_m = 0.2e-3;
  settings.select = {1};
  const auto job = make_job({square(20e-3), plate}, settings);
  ASSERT_TRUE(job) << job.error();
  EXPECT_TRUE(job->warnings.empty()) << "a hole is moved inwards: its tongue is cut";
  settings.select = {};
  const auto piece = make_job({plate}, settings);
  ASSERT_TRUE(piece) << piece.error();
  ASSERT_EQ(piece->warnings.size(), 1u);
  EXPECT_EQ(piece->warnings[0].find("contour 0: a slot or notch"), 0u) << piece->warnings[0];
}

TEST(Job, FramingStaysWithinReach) {
  JobSettings settings;
  settings.reach_m = 6e-3;
  const auto job = make_job({square(10e-3)}, settings);
  ASSERT_TRUE(job) << job.error();
  for (std::size_t i = 0; i < job->trajectory.size(); ++i) {
    if (job->phases[i] == JobPhase::kFraming) {
      ASSERT_LT(job->trajectory[i].position_m.norm(), 6e-3 + 1e-9);
      ASSERT_FALSE(job->trajectory[i].beam);
    }
  }
}

// A way from rest to rest takes as long as the speed or the acceleration that it may have asks for.
TEST(Job, WaysBetweenContoursAreOfLeastJerkAndAsFastAsTheyMayBe) {
  JobSettings settings;
  settings.framing = false;
  const auto job = make_job({square(4e-3)}, settings);
  ASSERT_TRUE(job);
  const Vec3 start = job->trajectory[0].position_m;
  for (const double way_m : {0.2e-3, 30e-3}) {
    const Vec3 from = start + Vec3(0, way_m, 0);
    const Job whole = approached_from(from, *job, settings);
    const double time_s = std::max(1.875 * way_m / 30e-3, std::sqrt(5.78 * way_m / 1.0));
    const auto ticks = static_cast<std::size_t>(std::ceil(time_s * 2400.0));
    ASSERT_EQ(whole.trajectory.size(), job->trajectory.size() + 1 + ticks) << way_m;
    for (std::size_t i = 0; i <= ticks; ++i) {
      const double u = static_cast<double>(i) / static_cast<double>(ticks),
                   t = static_cast<double>(ticks) / 2400.0;
      const Reference& r = whole.trajectory[i];
      EXPECT_NEAR(r.position_m.y(), from.y() - way_m * u * u * u * (10 - 15 * u + 6 * u * u), 1e-12);
      EXPECT_NEAR(r.velocity_m_per_s.y(), -way_m / t * 30 * u * u * (1 - u) * (1 - u), 1e-9);
      EXPECT_NEAR(r.acceleration_m_per_s2.y(), -way_m / (t * t) * 60 * u * (1 - u) * (1 - 2 * u), 1e-6);
      if (i > 0) {
        EXPECT_NEAR(r.speed_m_per_s, r.velocity_m_per_s.norm(), 1e-12);
      }
    }
  }
}

TEST(Job, RestsBeforeEachContourAndFramesTheirBox) {
  JobSettings settings;
  const auto job = make_job({square(4e-3), square(2e-3)}, settings, {1e-3, 0, 0});
  ASSERT_TRUE(job);
  std::size_t rests = 0;
  double left = 0, right = 0, bottom = 0, top = 0;
  std::vector<JobPhase> order;
  for (std::size_t i = 0; i < job->phases.size(); ++i) {
    if (order.empty() || order.back() != job->phases[i]) order.push_back(job->phases[i]);
    const Reference& r = job->trajectory[i];
    rests += job->phases[i] == JobPhase::kTravel && r.velocity_m_per_s.norm() == 0.0;
    if (job->phases[i] != JobPhase::kFraming) continue;
    left = std::min(left, r.position_m.x());
    right = std::max(right, r.position_m.x());
    bottom = std::min(bottom, r.position_m.y());
    top = std::max(top, r.position_m.y());
  }
  using enum JobPhase;
  EXPECT_EQ(order, (std::vector<JobPhase>{kApproach, kFraming, kTravel, kCut, kTravel, kCut, kReturn}));
  EXPECT_NEAR(static_cast<double>(rests), 2 * 0.3 * 2400, 4);
  for (const double edge : {-left, right, -bottom, top}) EXPECT_NEAR(edge, 2e-3, 1e-12);
  EXPECT_NEAR(job->cut_length_m, 4 * 4e-3 + 4 * 2e-3, 0.2e-3);
  EXPECT_LT((job->trajectory[job->trajectory.size() - 1].position_m - Vec3(1e-3, 0, 0)).norm(), 1e-9);
}

TEST(Job, ARestIsNoShorterThanItMustBe) {
  JobSettings settings;
  settings.framing = false;
  settings.settle_s = 0.2501;
  const auto job = make_job({square(2e-3)}, settings);
  ASSERT_TRUE(job);
  std::size_t rests = 0;
  for (const JobPhase phase : job->phases) rests += phase == JobPhase::kTravel ? 1 : 0;
  EXPECT_EQ(rests, 601u) << "600.24 ticks";
}

TEST(Job, AnIslandInAHoleIsAPieceAgain) {
  JobSettings settings;
  settings.kerf_m = 0.2e-3;
  const auto job = make_job({square(10e-3), square(7e-3), square(4e-3)}, settings);
  ASSERT_TRUE(job) << job.error();
  ASSERT_EQ(job->order, (std::vector<std::size_t>{2, 1, 0}));
  const double sides_mm[] = {4.2, 6.8, 10.2};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 size = geometry::bounding_box(job->lines[i].points_m).size();
    EXPECT_NEAR(1e3 * size.x(), sides_mm[i], 0.001) << i;
    EXPECT_NEAR(1e3 * size.y(), sides_mm[i], 0.001) << i;
  }
}

TEST(Job, ItsSettingsHaveTheseDefaultsAndNothingPlannedIsNothingDone) {
  const JobSettings settings;
  EXPECT_TRUE(settings.framing);
  EXPECT_EQ(settings.travel_m_per_s, 30e-3);
  EXPECT_EQ(settings.travel_m_per_s2, 1.0);
  EXPECT_EQ(settings.kerf_m, 0.0);
  EXPECT_EQ(settings.settle_s, 0.3);
  EXPECT_EQ(settings.reach_m, 0.1);
  EXPECT_EQ(JobExecutorSettings{}.laser_w, 10.0);
  const JobExecutorOutputs out;
  EXPECT_FALSE(out.pilot || out.done || out.saturated);
  EXPECT_EQ(out.laser_w, 0.0);
  EXPECT_EQ(out.tick, 0u);
  EXPECT_EQ(out.progress, 0.0);
}

TEST(Job, RefusesAnEmptyOne) { EXPECT_FALSE(make_job({}, JobSettings{})); }

class AtWork : public testing::Test {
 protected:
  robot::RobotModel model = robot::load_robot("slave-keops");
  robot::SimulatedRobot plant{robot::mismatched(model, 0.1, 7), 7, model.in_base(Vec3::Zero())};
  tl::expected<Job, std::string> job = make_job({square(2e-3)}, JobSettings{});
  geometry::NearestIndex corridor{square(2e-3)};
};

TEST_F(AtWork, TheBeamIsOnAlongTheContourOnly) {
  JobExecutor executor(model, *job, {});
  executor.reset(plant.read().joints_m);
  double lit_m = 0.0;
  bool framed = false, done = false;
  for (std::size_t i = 0; i < job->trajectory.size() && !done; ++i) {
    const Vec3 before = model.in_workpiece(plant.true_tool_in_base_m());
    const auto out = executor.step(plant.read(), false);
    plant.write(out.currents_a);
    plant.advance(job->period_s);
    if (out.laser_w > 0.0) {
      lit_m += (model.in_workpiece(plant.true_tool_in_base_m()) - before).norm();
      EXPECT_LT(corridor.find(before.head<2>()).distance_m, 40e-6);
      EXPECT_EQ(out.phase, JobPhase::kCut);
    }
    ASSERT_EQ(out.pilot, out.phase == JobPhase::kFraming) << i;
    framed = framed || out.pilot;
    done = out.done;
  }
  EXPECT_TRUE(done);
  EXPECT_TRUE(framed);
  EXPECT_NEAR(lit_m, 8e-3, 0.3e-3);
}

TEST_F(AtWork, EveryContourIsCutWithinItsOwnCorridor) {
  // A closed one around an open one: each has its own law and its own corridor.
  const geometry::Polyline stroke{{{-0.5e-3, 0.1e-3}, {0.5e-3, 0.1e-3}}, false};
  JobSettings settings;
  settings.framing = false;
  job = make_job({square(3e-3), stroke}, settings);
  ASSERT_TRUE(job) << job.error();
  ASSERT_EQ(job->order, (std::vector<std::size_t>{1, 0}));
  const geometry::NearestIndex corridors[] = {geometry::NearestIndex(stroke),
                                              geometry::NearestIndex(square(3e-3))};
  JobExecutor executor(model, *job, {});
  executor.reset(plant.read().joints_m);
  std::vector<double> lit_m;
  bool cutting = false;
  for (std::size_t i = 0; i < job->trajectory.size(); ++i) {
    const Vec3 before = model.in_workpiece(plant.true_tool_in_base_m());
    const auto out = executor.step(plant.read(), false);
    plant.write(out.currents_a);
    plant.advance(job->period_s);
    if (out.phase == JobPhase::kCut && !cutting) lit_m.push_back(0.0);
    cutting = out.phase == JobPhase::kCut;
    if (out.laser_w > 0.0) {
      ASSERT_LT(corridors[lit_m.size() - 1].find(before.head<2>()).distance_m, 40e-6);
      lit_m.back() += (model.in_workpiece(plant.true_tool_in_base_m()) - before).norm();
    }
  }
  ASSERT_EQ(lit_m.size(), 2u);
  EXPECT_NEAR(lit_m[0], 1e-3, 0.1e-3);
  EXPECT_NEAR(lit_m[1], 12e-3, 0.4e-3);
}

TEST_F(AtWork, AToolThatRestsElsewhereIsBroughtToTheStartFirst) {
  const Vec3 elsewhere_m(2e-3, -3e-3, -1e-3);
  plant = robot::SimulatedRobot(robot::mismatched(model, 0.1, 7), 7, model.in_base(elsewhere_m));
  const Job whole = approached_from(elsewhere_m, *job, JobSettings{});
  ASSERT_EQ(whole.phases.size(), whole.trajectory.size());
  ASSERT_GT(whole.trajectory.size(), job->trajectory.size() + 240u);
  EXPECT_EQ(whole.trajectory[0].position_m, elsewhere_m);
  EXPECT_EQ(whole.phases.front(), JobPhase::kApproach);
  JobExecutor executor(model, whole, {});
  executor.reset(plant.read().joints_m);
  double lit_s = 0.0;
  for (std::size_t i = 0; i < whole.trajectory.size(); ++i) {
    const auto out = executor.step(plant.read(), false);
    EXPECT_LT((out.tool_m - out.reference_m).norm(), 100e-6) << i;
    plant.write(out.currents_a);
    plant.advance(whole.period_s);
    if (out.laser_w > 0.0) lit_s += whole.period_s;
  }
  EXPECT_NEAR(lit_s, 8e-3 / 8e-3, 0.05);
}

TEST_F(AtWork, EachMillimetreGetsWhatWasPlannedByTheSpeedThatIsMeasured) {
  JobExecutorSettings settings;
  settings.laser_w = 8.0;
  JobExecutor executor(model, *job, settings);
  executor.reset(plant.read().joints_m);
  int lit = 0;
  const auto last = static_cast<double>(job->trajectory.size() - 1);
  for (std::size_t i = 0; i < job->trajectory.size(); ++i) {
    const auto out = executor.step(plant.read(), false);
    plant.write(out.currents_a);
    plant.advance(job->period_s);
    ASSERT_EQ(out.tick, i);
    ASSERT_EQ(out.progress, static_cast<double>(i) / last);
    ASSERT_EQ(out.done, i + 1 == job->trajectory.size());
    ASSERT_FALSE(out.saturated);
    const Reference& r = job->trajectory[i];
    ASSERT_EQ(out.reference_m, r.position_m);
    ASSERT_LT((out.tool_m - r.position_m).norm(), 20e-6) << i;
    if (!r.beam) {
      ASSERT_EQ(out.laser_w, 0.0);
      continue;
    }
    ASSERT_EQ(out.interlock, Interlock::kReady) << i;
    const double ratio = out.tool_velocity_m_per_s.dot(r.tangent) / r.speed_m_per_s;
    ASSERT_NEAR(out.laser_w, 8.0 * r.power * std::clamp(ratio, 0.0, 1.5), 1e-12) << i;
    lit += out.laser_w > 0.0 ? 1 : 0;
  }
  EXPECT_GT(lit, 2000);
  const auto after = executor.step(plant.read(), false);
  EXPECT_TRUE(after.done) << "and it stays so";
  EXPECT_EQ(after.tick, job->trajectory.size() - 1);
}

TEST_F(AtWork, EachDoubtPutsTheBeamOutAtItsVeryStep) {
  robot::RobotModel narrow = model;
  narrow.workspace.radius_m = 1.2e-3;  // the square's corners are 1.41 mm away
  JobExecutor executor(narrow, *job, {});
  executor.reset(plant.read().joints_m);
  int stale = 0, beyond = 0, tracking = 0, ready = 0;
  for (std::size_t i = 0; i < job->trajectory.size(); ++i) {
    auto reading = plant.read();
    const bool cut = job->phases[i] == JobPhase::kCut;
    if (cut && i % 100 == 0) reading.valid = false;
    plant.set_tool_force({0.0, 0.0, cut && i / 300 % 2 == 1 ? 12.0 : 0.0});
    const auto out = executor.step(reading, false);
    plant.write(out.currents_a);
    plant.advance(job->period_s);
    if (out.interlock != Interlock::kReady) {
      ASSERT_EQ(out.laser_w, 0.0) << i;
    }
    if (!cut) {
      ASSERT_EQ(out.interlock, Interlock::kNotEngaged);
      continue;
    }
    const double arc_m = job->trajectory[i].arc_length_m;
    if (arc_m < -0.4e-3 || arc_m > job->plans[0].path.length_m() + 0.4e-3) continue;  // outside its corridor
    const double off_m = (out.tool_m - out.reference_m).norm();
    const Interlock expected = !reading.valid                         ? Interlock::kStale
                               : out.tool_m.head<2>().norm() > 1.2e-3 ? Interlock::kOutsideWorkspace
                               : off_m < 50e-6                        ? Interlock::kReady
                                                                      : Interlock::kTracking;
    ASSERT_EQ(out.interlock, expected) << i << " " << off_m;
    stale += expected == Interlock::kStale;
    beyond += expected == Interlock::kOutsideWorkspace;
    tracking += expected == Interlock::kTracking;
    ready += expected == Interlock::kReady;
  }
  EXPECT_GT(stale, 20);
  EXPECT_GT(beyond, 300);
  EXPECT_GT(tracking, 20);
  EXPECT_GT(ready, 500);
}

TEST_F(AtWork, TheBeamsPowerFollowsTheSpeedAlongThePathBetweenNothingAndHalfAsMuchAgain) {
  PathFollowerSettings settings;
  const Controller controller = make_controller(ControllerKind::kContouring, true, settings);
  PathFollower follower(model, joint_settings(ControllerKind::kContouring, settings), controller,
                        model_use(ControllerKind::kContouring, settings));
  Vec3 joints_m = plant.read().joints_m;
  follower.reset(joints_m);
  const Trajectory rest({Reference{}});
  for (int n = 0; n < 200; ++n) {
    joints_m.x() += 5e-6;
    (void)follower.step({.joints_m = joints_m, .valid = true}, rest, 0.0);
  }
  const Vec3 velocity = follower.joints().state().tool_velocity_m_per_s;
  ASSERT_GT(velocity.norm(), 5e-3);
  Reference reference;
  reference.power = 0.8;
  reference.tangent = velocity.normalized();
  for (const double ratio : {0.01, 0.5, 1.0, 1.45, 1.6, 10.0}) {
    reference.speed_m_per_s = velocity.norm() / ratio;
    EXPECT_NEAR(follower.beam_power(reference), 0.8 * std::min(ratio, 1.5), 1e-12) << ratio;
  }
  reference.tangent = -reference.tangent;
  EXPECT_EQ(follower.beam_power(reference), 0.0) << "backwards nothing";
  reference.tangent = -reference.tangent;
  reference.speed_m_per_s = 0.0;
  EXPECT_EQ(follower.beam_power(reference), 0.0) << "nor at rest";
}

TEST_F(AtWork, ThePilotBeamIsOffWithoutAReadingAndAfterAStop) {
  JobExecutor executor(model, *job, {});
  executor.reset(plant.read().joints_m);
  JobExecutorOutputs out;
  for (std::size_t i = 0; i < job->trajectory.size() && !out.pilot; ++i)
    out = executor.step(plant.read(), false);
  ASSERT_TRUE(out.pilot);
  EXPECT_FALSE(executor.step({}, false).pilot);
  EXPECT_TRUE(executor.step(plant.read(), false).pilot);
  EXPECT_FALSE(executor.step(plant.read(), true).pilot);
  EXPECT_FALSE(executor.step(plant.read(), false).pilot);
}

TEST_F(AtWork, AStopPutsTheBeamOutAtOnceAndHoldsTheToolForGood) {
  JobExecutor executor(model, *job, {});
  executor.reset(plant.read().joints_m);
  bool lit = false;
  int after = 0;
  Vec3 held = Vec3::Zero();
  for (std::size_t i = 0; i < job->trajectory.size() && after < 2400; ++i) {
    const auto out = executor.step(plant.read(), lit);
    if (lit) {
      EXPECT_EQ(out.laser_w, 0.0);
      EXPECT_EQ(out.interlock, Interlock::kStopped);
      if (after++ == 0) held = out.reference_m;
      if (after > 1200) {
        EXPECT_LT((out.tool_m - held).norm(), 10e-6);
      }
    }
    lit = lit || out.laser_w > 5.0;
    plant.write(out.currents_a);
    plant.advance(job->period_s);
  }
  EXPECT_EQ(after, 2400);
}

}  // namespace
}  // namespace telekerf::machining
