// SPDX-License-Identifier: Apache-2.0
// What the master is about, step by step: every way from mode to mode, and the motion to the curve.
#include <gtest/gtest.h>

#include <cmath>

#include "master/constraint/guide_curve.h"
#include "master/modes.h"

namespace telekerf::master {
namespace {

constexpr double kDt_s = 1e-3;

ContourMessage square(double half_m) {
  ContourMessage contour;
  contour.id = 4;
  for (const Vec2& corner : {Vec2(1, 1), Vec2(-1, 1), Vec2(-1, -1), Vec2(1, -1)}) {
    for (int n = 0; n < 50; ++n) {
      const Vec2 along(-corner.y(), corner.x());
      contour.points_m.emplace_back(half_m * corner + n / 50.0 * half_m * (along - corner));
    }
  }
  return contour;
}

class ModesTest : public testing::Test {
 protected:
  bool step(bool engage = false, bool ready = false) {
    return modes_.step(
        {.guide = guide_, .tool_m = tool_m_, .stopped = stopped_, .engage = engage, .slave_ready = ready});
  }
  /// Steps until the hand is guided.
  int approach() {
    int steps = 0;
    for (; modes_.mode() == MasterMode::kApproach && steps < 10'000; ++steps) {
      step();
      (void)modes_.goal();
    }
    return steps;
  }

  GuidePath path_ = make_guide(square(0.01), 0.5, {});
  GuidePath other_ = make_guide(square(0.012), 0.5, {});
  const GuidePath* guide_ = nullptr;
  Vec3 tool_m_ = Vec3(1e-3, 2e-3, 3e-3);
  bool stopped_ = false;
  Modes modes_{0.05, kDt_s};
};

TEST_F(ModesTest, WithoutAContourItHoldsWhereItRests) {
  modes_.rest_at(tool_m_);
  EXPECT_FALSE(step(true, true));
  EXPECT_EQ(modes_.mode(), MasterMode::kIdle);
  EXPECT_EQ(modes_.guide(), nullptr);
  EXPECT_EQ(modes_.goal().position_m, tool_m_);
  EXPECT_EQ(modes_.goal().velocity_m_per_s, Vec3(Vec3::Zero()));
}

/// From (1, 2, 3) mm to the nearest point of the curve, (1, 20, 0) mm, 18.25 mm away at 50 mm/s in the mean.
TEST_F(ModesTest, TheToolIsBroughtStraightToTheNearestPointAndComesToRestFirst) {
  guide_ = &path_;
  EXPECT_TRUE(step()) << "another curve";
  EXPECT_EQ(modes_.mode(), MasterMode::kApproach);
  EXPECT_EQ(modes_.guide(), guide_);
  tool_m_ = Vec3(-5e-3, 19e-3, 0.0);  // a straight piece of the curve, and near: half a second at least
  modes_ = Modes(0.05, kDt_s);
  EXPECT_TRUE(step());
  KinematicState before = modes_.goal();
  const Vec3 to_m(-5e-3, 20e-3, 0.0);
  for (int n = 2; n <= 600; ++n) {
    EXPECT_FALSE(step());
    const KinematicState goal = modes_.goal();
    const double u = std::min(1.0, n * kDt_s / 0.5);
    const double place = u * u * u * (10 - 15 * u + 6 * u * u);
    ASSERT_LT((goal.position_m - (tool_m_ + place * (to_m - tool_m_))).norm(), 1e-8) << n;
    ASSERT_LT((0.5 * (goal.velocity_m_per_s + before.velocity_m_per_s) -
               (goal.position_m - before.position_m) / kDt_s)
                  .norm(),
              1e-6);
    ASSERT_LT((0.5 * (goal.acceleration_m_per_s2 + before.acceleration_m_per_s2) -
               (goal.velocity_m_per_s - before.velocity_m_per_s) / kDt_s)
                  .norm(),
              1e-4);
    before = goal;
  }
  EXPECT_EQ(modes_.mode(), MasterMode::kApproach);
  EXPECT_NEAR(600 + approach(), 1002, 1) << "half a second of motion, half a second of rest";
  EXPECT_EQ(modes_.mode(), MasterMode::kGuiding);
}

TEST_F(ModesTest, AFarToolTakesItsTimeByTheMeanSpeed) {
  guide_ = &path_;
  tool_m_ = Vec3(0.0, 0.045, 0.0);
  step();
  EXPECT_NEAR(approach(), 500 + 500, 3) << "25 mm at 50 mm/s";
  tool_m_ = Vec3(0.0, 0.08, 0.0);
  modes_ = Modes(0.05, kDt_s);
  step();
  EXPECT_NEAR(approach(), 1200 + 500, 3) << "60 mm";
}

TEST_F(ModesTest, EngagingNeedsTheWishAndAReadySlaveAndEndsWithEither) {
  guide_ = &path_;
  step();
  approach();
  for (const auto& [engage, ready] : {std::pair{false, false}, {true, false}, {false, true}}) {
    EXPECT_FALSE(step(engage, ready));
    EXPECT_EQ(modes_.mode(), MasterMode::kGuiding);
    EXPECT_FALSE(modes_.engage_spent()) << "who waits for the slave goes on waiting";
    EXPECT_FALSE(step(true, true));
    EXPECT_EQ(modes_.mode(), MasterMode::kEngaged);
    EXPECT_FALSE(modes_.engage_spent());
    EXPECT_FALSE(step(true, true));
    EXPECT_EQ(modes_.mode(), MasterMode::kEngaged);
    EXPECT_FALSE(step(engage, ready));
    EXPECT_EQ(modes_.mode(), MasterMode::kGuiding);
    EXPECT_TRUE(modes_.engage_spent()) << "it has to be said anew";
  }
}

TEST_F(ModesTest, AStopHoldsTheToolWhereItIsUntilItIsCleared) {
  guide_ = &path_;
  step();
  approach();
  step(true, true);
  tool_m_ = Vec3(4e-3, 5e-3, 0.0);
  stopped_ = true;
  EXPECT_FALSE(step(true, true));
  EXPECT_TRUE(modes_.engage_spent());
  EXPECT_EQ(modes_.mode(), MasterMode::kStopped);
  EXPECT_EQ(modes_.goal().position_m, tool_m_);
  const Vec3 held_m = tool_m_;
  tool_m_ = Vec3(9e-3, 9e-3, 0.0);
  guide_ = &other_;
  EXPECT_FALSE(step(true, true));
  EXPECT_EQ(modes_.guide(), &other_) << "the one before may be gone";
  EXPECT_EQ(modes_.goal().position_m, held_m);
  stopped_ = false;
  EXPECT_TRUE(step(true, true));
  EXPECT_EQ(modes_.mode(), MasterMode::kApproach) << "led to the curve anew";
}

TEST_F(ModesTest, AContourThatGoesOrChangesIsAnotherBeginning) {
  guide_ = &path_;
  step();
  approach();
  EXPECT_FALSE(modes_.engage_spent());
  guide_ = &other_;
  EXPECT_TRUE(step(true, true));
  EXPECT_TRUE(modes_.engage_spent());
  EXPECT_EQ(modes_.mode(), MasterMode::kApproach);
  EXPECT_EQ(modes_.guide(), &other_);
  guide_ = nullptr;
  EXPECT_TRUE(step(true, true));
  EXPECT_EQ(modes_.mode(), MasterMode::kIdle);
  EXPECT_EQ(modes_.goal().position_m, tool_m_);
  EXPECT_FALSE(step(true, true));
}

}  // namespace
}  // namespace telekerf::master
