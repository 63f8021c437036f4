// SPDX-License-Identifier: Apache-2.0
// The second judgement: its kinematics and its corridor against the first one's, and what it takes for a
// fault.
#include "slave/laser/beam_monitor.h"

#include <random>

#include "tests/unit/slave/commanded_slave.h"

namespace telekerf::slave {
namespace {

TEST(SingleKinematics, AgreesWithTheOtherToTwoMicrometresOnEveryShippedRobot) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const char* name : {"slave-keops", "master-horizontal", "vertical", "asymmetric"}) {
    const robot::RobotModel model = robot::load_robot(name);
    const robot::DeltaKinematics kinematics(model.geometry);
    const laser::SingleKinematics single(model);
    for (int n = 0; n < 1000; ++n) {
      const double reach_m = model.workspace.radius_m / std::sqrt(2.0);
      const Vec3 tool_m(reach_m * unit(random), reach_m * unit(random),
                        0.5 * model.workspace.height_m * unit(random));
      const Vec3 joints_m = kinematics.inverse(model.in_base(tool_m)).value();
      const auto found = single.tool_m({static_cast<float>(joints_m[0]), static_cast<float>(joints_m[1]),
                                        static_cast<float>(joints_m[2])});
      ASSERT_LT((Vec3(found[0], found[1], found[2]) - tool_m).norm(), 2e-6) << name;
    }
    EXPECT_TRUE(std::isnan(single.tool_m({10.0F, 10.0F, -10.0F})[0])) << name;
  }
}

TEST(CorridorRaster, IsTheCorridorButForACell) {
  std::vector<Vec2> points{{-3e-3, 0.0}, {2e-3, 1e-3}, {1e-3, -2e-3}};
  const laser::CorridorRaster open({points, false}, 0.5e-3, 10e-3);
  const laser::CorridorRaster closed({points, true}, 0.5e-3, 10e-3);
  const geometry::NearestIndex open_line({points, false});
  const geometry::NearestIndex closed_line({points, true});
  for (double x = -5e-3; x < 5e-3; x += 0.07e-3) {
    for (double y = -5e-3; y < 5e-3; y += 0.07e-3) {
      for (const auto& [raster, line] : {std::pair{&open, &open_line}, {&closed, &closed_line}}) {
        const double off_m = line->find({x, y}).distance_m - 0.5e-3;
        if (std::abs(off_m) < 0.036e-3) continue;
        ASSERT_EQ(raster->holds(static_cast<float>(x), static_cast<float>(y)), off_m < 0.0) << x << " " << y;
      }
    }
  }
  EXPECT_FALSE(open.holds(std::nanf(""), 0.0F));
  EXPECT_FALSE(open.holds(1.0F, 0.0F));
  EXPECT_FALSE(open.holds(0.0F, -1.0F));
}

TEST(CorridorRaster, HoldsEachCellWhoseMiddleIsWithinUpToTheWorkspacesEdge) {
  constexpr double kCell_m = 0.05e-3, kHalf_m = 0.5e-3, kRadius_m = 10e-3;
  const std::vector<Vec2> lines[] = {{{-kRadius_m, 0.03e-3}, {kRadius_m, 0.03e-3}},
                                     {{0.03e-3, -kRadius_m}, {0.03e-3, kRadius_m}},
                                     {{-2.03e-3, 0.03e-3}, {3.03e-3, 0.03e-3}},
                                     {{0.03e-3, -2.03e-3}, {0.03e-3, 3.03e-3}}};
  const auto middle_m = [](int n) { return (n + 0.5) * kCell_m - kRadius_m - 2.0 * kHalf_m; };
  for (const std::vector<Vec2>& points : lines) {
    const laser::CorridorRaster raster({points, false}, kHalf_m, kRadius_m);
    const geometry::NearestIndex line({points, false});
    int held = 0;
    for (int row = 0; row < 440; ++row) {
      for (int column = 0; column < 440; ++column) {
        const Vec2 at_m(middle_m(column), middle_m(row));
        const double off_m = line.find(at_m).distance_m - kHalf_m;
        if (std::abs(off_m) < 1e-7) continue;
        ASSERT_EQ(raster.holds(static_cast<float>(at_m.x()), static_cast<float>(at_m.y())), off_m < 0.0)
            << at_m.transpose();
        held += off_m < 0.0 ? 1 : 0;
      }
    }
    EXPECT_GT(held, 2000);
    // About the very end, one float after the other: nothing behind the cells is read.
    for (float end_m = 10.9999e-3F; end_m < 11.0001e-3F; end_m = std::nextafter(end_m, 1.0F)) {
      ASSERT_FALSE(raster.holds(0.0F, end_m));
      ASSERT_FALSE(raster.holds(end_m, 0.0F));
    }
  }
}

class Monitor : public testing::Test {
 protected:
  robot::JointReading at(const Vec3& tool_m) const {
    return {.joints_m = robot::DeltaKinematics(model_.geometry).inverse(model_.in_base(tool_m)).value(),
            .valid = true};
  }
  const robot::RobotModel model_ = robot::load_robot("slave-keops");
  const std::vector<Vec2> points_{{-3e-3, 0.0}, {3e-3, 0.0}};
  const laser::CorridorRaster corridor_{{points_, false}, 0.5e-3, 10e-3};
  laser::BeamMonitor monitor_{model_, 0.5e-3};
};

TEST_F(Monitor, LightWhereNoneMayBeIsAFaultAtTheSecondStepAndStaysOne) {
  const Vec3 good_m(1e-3, 0.2e-3, 0.0);
  struct Case {
    robot::JointReading reading;
    const laser::CorridorRaster* corridor;
    bool stopped;
  };
  robot::JointReading none = at(good_m);
  none.valid = false;
  for (const Case& bad : {Case{at({1e-3, 0.6e-3, 0.0}), &corridor_, false},
                          {at({1e-3, 0.0, 0.6e-3}), &corridor_, false},
                          {at({1e-3, 0.0, -0.6e-3}), &corridor_, false},
                          {at({1e-3, -0.6e-3, 0.0}), &corridor_, false},
                          {none, &corridor_, false},
                          {at(good_m), nullptr, false},
                          {at(good_m), &corridor_, true}}) {
    monitor_ = laser::BeamMonitor(model_, 0.5e-3);
    for (int n = 0; n < 3; ++n) {
      monitor_.step(bad.reading, bad.corridor, bad.stopped, false);
      monitor_.step(bad.reading, bad.corridor, bad.stopped, true);
      monitor_.step(at(good_m), &corridor_, false, true);
      EXPECT_TRUE(monitor_.agrees()) << "never twice in a row";
    }
    monitor_.step(bad.reading, bad.corridor, bad.stopped, true);
    EXPECT_TRUE(monitor_.agrees());
    monitor_.step(bad.reading, bad.corridor, bad.stopped, true);
    EXPECT_FALSE(monitor_.agrees());
    for (int n = 0; n < 10; ++n) monitor_.step(at(good_m), &corridor_, false, false);
    EXPECT_FALSE(monitor_.agrees());
  }
}

TEST_F(SlaveNodeTest, TheSecondJudgementNeverForbidsAGoodLap) {
  each_tick_ = [&] { ASSERT_EQ(out_.forbidden & laser::guard_bit("monitor"), 0u); };
  follow(5.0);
  EXPECT_GT(laser_ticks_, 1000);
}

/// A contour of which the second judgement has drawn another one.
TEST_F(SlaveNodeTest, WhereTheJudgementsDisagreeTheBeamGoesOutForGood) {
  follow(3.0);
  ASSERT_GT(out_.laser_w, 0.0);
  corridor_->raster.emplace(geometry::Polyline{std::vector<Vec2>{{0.0, 0.0}, {1e-3, 0.0}}, false}, 0.5e-3,
                            15e-3);
  laser_ticks_ = 0;
  follow(1.0);
  EXPECT_EQ(laser_ticks_, 2);
  EXPECT_EQ(out_.interlock, Interlock::kMonitor);
  EXPECT_EQ(out_.forbidden, laser::guard_bit("monitor"));
}

}  // namespace
}  // namespace telekerf::slave
