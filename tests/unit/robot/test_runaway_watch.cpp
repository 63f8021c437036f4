// SPDX-License-Identifier: Apache-2.0
// The watch's bounds of place and speed, each alone: reached they hold, beyond them the robot is let go. What
// a whole robot does is in tests/unit/simulation/test_runaway.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "common/robot/runaway.h"

namespace telekerf::robot {
namespace {

using Cause = RunawayWatch::Cause;

struct Watch : RunawayWatch {
  explicit Watch(Pushed pushed = Pushed::kNo) : RunawayWatch(load_robot("slave-keops"), 1e-3, pushed) {}
  Cause reads(const Vec3& joints_m, int times = 1) {
    for (int n = 0; n < times; ++n) read({.joints_m = joints_m, .valid = true}, 1);
    return cause();
  }
  Cause stands_at(const Vec3& tool_m) {
    at(tool_m);
    return cause();
  }
};

TEST(RunawayWatch, AJointThatLeavesItsStrokeIsLetGoAndOneThatBeginsOutsideMayComeIn) {
  const DeltaGeometry geometry = load_robot("slave-keops").geometry;
  const double middle_m = 0.5 * (geometry.stroke_min_m + geometry.stroke_max_m);
  for (const int joint : {0, 1, 2}) {
    for (const bool above : {false, true}) {
      const auto beyond = [&](double by_m) {
        Vec3 joints_m = Vec3::Constant(middle_m);
        joints_m[joint] = above ? geometry.stroke_max_m + by_m : geometry.stroke_min_m - by_m;
        return joints_m;
      };
      Watch watch;
      // Slowly, as another bound judges the speed.
      for (double by_m = -1e-3; by_m < 0.09e-3; by_m += 0.05e-3)
        ASSERT_EQ(watch.reads(beyond(by_m), 6), Cause::kNone) << joint << " " << by_m;
      EXPECT_EQ(watch.reads(beyond(0.11e-3)), Cause::kStroke);
      EXPECT_NE(watch.sentence().find("beyond its stroke"), std::string::npos) << watch.sentence();
      EXPECT_EQ(watch.reads(beyond(-1e-3)), Cause::kStroke) << "for good";
      Watch outside;
      EXPECT_EQ(outside.reads(beyond(0.2e-3), 10), Cause::kNone);
      EXPECT_EQ(Watch(Pushed::kYes).reads(beyond(0.2e-3), 10), Cause::kNone);
    }
  }
}

TEST(RunawayWatch, AJointFasterThanItIsEverAskedToBeIsLetGo) {
  const RobotModel model = load_robot("slave-keops");
  const double middle_m = 0.5 * (model.geometry.stroke_min_m + model.geometry.stroke_max_m);
  const auto runs_at = [&](double m_per_s, Pushed pushed = Pushed::kNo) {
    Watch watch(pushed);
    for (int n = -6; n <= 6; ++n) watch.reads(Vec3(middle_m, middle_m + n * 1e-3 * m_per_s, middle_m));
    return watch.cause();
  };
  EXPECT_EQ(runs_at(model.limits.velocity_m_per_s), Cause::kNone);
  const double within_stroke_m_per_s = 0.9 * (model.geometry.stroke_max_m - middle_m) / 6e-3;
  ASSERT_GT(within_stroke_m_per_s, 3.0 * model.limits.velocity_m_per_s);
  EXPECT_EQ(runs_at(within_stroke_m_per_s), Cause::kSpeed);
  EXPECT_EQ(runs_at(-within_stroke_m_per_s), Cause::kSpeed);
  EXPECT_EQ(runs_at(within_stroke_m_per_s, Pushed::kYes), Cause::kNone);
}

TEST(RunawayWatch, AToolFarOutsideOfTheWorkspaceIsLetGoOnceItWasWithin) {
  const RobotModel model = load_robot("slave-keops");
  const double radius_m = model.workspace.radius_m, half_m = 0.5 * model.workspace.height_m;
  const double aside_m = radius_m + std::max(5e-3, 0.3 * radius_m),
               up_m = half_m + std::max(5e-3, 0.3 * half_m);
  for (const Vec3& edge : {Vec3(aside_m, 0, 0), Vec3(0, -aside_m, 0), Vec3(0, 0, up_m), Vec3(0, 0, -up_m)}) {
    Watch watch;
    EXPECT_EQ(watch.stands_at(1.001 * edge), Cause::kNone) << "as it was put there";
    EXPECT_EQ(watch.stands_at(Vec3::Zero()), Cause::kNone);
    EXPECT_EQ(watch.stands_at(0.999 * edge), Cause::kNone);
    EXPECT_EQ(watch.stands_at(1.001 * edge), Cause::kWorkspace);
    EXPECT_NE(watch.sentence().find("far outside"), std::string::npos);
    Watch pushed(Pushed::kYes);
    pushed.at(Vec3::Zero());
    EXPECT_EQ(pushed.stands_at(1.001 * edge), Cause::kNone);
  }
}

TEST(RunawayWatch, AReadingThatIsNotFiniteIsNoPlaceOfAnyRobot) {
  for (const Pushed pushed : {Pushed::kNo, Pushed::kYes}) {
    Watch watch(pushed);
    EXPECT_EQ(watch.reads(Vec3(0.02, 0.02, std::numeric_limits<double>::infinity())), Cause::kNotFinite);
    EXPECT_NE(watch.sentence().find("joint 3 is read at inf m, which is no place"), std::string::npos);
  }
}

}  // namespace
}  // namespace telekerf::robot
