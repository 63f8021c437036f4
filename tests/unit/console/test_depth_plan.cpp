// SPDX-License-Identifier: Apache-2.0
// The speed that gives a depth, and the depth that a hand's motion has given.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "common/workpiece/line_depth.h"
#include "master/console/depth_plan.h"

namespace telekerf::master {
namespace {

using workpiece::kFibreglass;
using workpiece::kWood;

const CutPower kCut;

TEST(DepthPlan, APassHasOneDepthUpToTheSpeedThatThePowerFollows) {
  const DepthPlan plan(kCut, kWood, 0.0);
  EXPECT_NEAR(plan.pass_m(), workpiece::depth_speed_m2_per_s(kWood, kCut.laser_w) / 10e-3, 1e-12);
  EXPECT_DOUBLE_EQ(plan.full_speed_m_per_s(), 15e-3);
  EXPECT_FALSE(plan.speed_m_per_s()) << "none is wished";
  EXPECT_EQ(plan.sentence().find("move at"), std::string::npos);
}

TEST(DepthPlan, SaysTheSpeedOrHowManyPasses) {
  const double pass_m = DepthPlan(kCut, kWood, 0.0).pass_m();
  const DepthPlan half(kCut, kWood, 0.5 * pass_m);
  ASSERT_TRUE(half.speed_m_per_s());
  EXPECT_NEAR(*half.speed_m_per_s(), 30e-3, 1e-12);
  EXPECT_NE(half.sentence().find("move at 30 mm/s"), std::string::npos) << half.sentence();
  const DepthPlan deeper(kCut, kWood, 2.5 * pass_m);
  EXPECT_FALSE(deeper.speed_m_per_s());
  EXPECT_NE(deeper.sentence().find("takes 2.5 passes, or one with --laser-speed-mm-s 4.0"), std::string::npos)
      << deeper.sentence();
  const DepthPlan through(kCut, kFibreglass, 1e-3);
  EXPECT_NE(through.sentence().find("is all of its 0.50 mm"), std::string::npos) << through.sentence();
}

TEST(DepthPlan, PulsesTooWeakForTheMaterialAreSaid) {
  workpiece::Material hard = kWood;
  hard.threshold_j_per_m2 = 1e9;
  EXPECT_EQ(DepthPlan(kCut, hard, 1e-4).sentence(), "These pulses remove nothing of wood");
}

geometry::Polyline circle() {
  geometry::Polyline line{{}, true};
  for (int n = 0; n < 720; ++n)
    line.points_m.emplace_back(10e-3 * std::cos(M_PI * n / 360), 10e-3 * std::sin(M_PI * n / 360));
  return line;
}

/// Rounds at one speed, by samples of 1 ms.
void go_round(DepthTrail& trail, double speed_m_per_s, double rounds) {
  const auto samples = static_cast<int>(rounds * 2.0 * M_PI * 10e-3 / speed_m_per_s / 1e-3);
  for (int n = 0; n < samples; ++n) {
    const double angle = speed_m_per_s * 1e-3 * n / 10e-3;
    trail.burn({10e-3 * std::cos(angle), 10e-3 * std::sin(angle)}, speed_m_per_s, 1e-3);
  }
}

class Trail : public testing::Test {
 protected:
  void SetUp() override { trail.begin(circle()); }
  std::vector<float> depths() const { return trail.depths_m(kCut, kWood); }
  double mean() const {
    const auto all = depths();
    return std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size());
  }
  DepthTrail trail;
};

TEST_F(Trail, IsAsDeepAsThePlanSaysAtEverySpeed) {
  const double pass_m = DepthPlan(kCut, kWood, 0.0).pass_m();
  for (const double speed_m_per_s : {2e-3, 8e-3, 15e-3}) {
    trail.begin(circle());
    go_round(trail, speed_m_per_s, 1.0);
    EXPECT_NEAR(mean(), pass_m, 0.01 * pass_m) << speed_m_per_s;
  }
  for (const double share : {0.75, 0.4}) {
    trail.begin(circle());
    go_round(trail, *DepthPlan(kCut, kWood, share * pass_m).speed_m_per_s(), 1.0);
    EXPECT_NEAR(mean(), share * pass_m, 0.02 * pass_m) << share;
  }
}

TEST_F(Trail, PassesAddUpToTheThicknessAndNoFurther) {
  const double pass_m = DepthPlan(kCut, kWood, 0.0).pass_m();
  go_round(trail, 10e-3, 2.0);
  EXPECT_NEAR(mean(), 2.0 * pass_m, 0.02 * pass_m);
  go_round(trail, 2e-3, 2.0 + kWood.thickness_m / pass_m);
  for (const float depth_m : depths()) EXPECT_NEAR(depth_m, kWood.thickness_m, 1e-6);
}

TEST_F(Trail, AQuarterOfTheWayLeavesTheRestUncut) {
  go_round(trail, 10e-3, 0.25);
  const auto all = depths();
  for (std::size_t n = 0; n < all.size() / 4 - 1; ++n) EXPECT_GT(all[n], 0.0F) << n;
  for (std::size_t n = all.size() / 4 + 1; n < all.size(); ++n) EXPECT_EQ(all[n], 0.0F) << n;
}

TEST_F(Trail, WhatBurnsElsewhereOrRestsCutsNothing) {
  const auto version = trail.version();
  trail.burn({0.0, 0.0}, 10e-3, 1e-3);
  trail.burn({std::numeric_limits<double>::quiet_NaN(), 0.0}, 10e-3, 1e-3);
  EXPECT_EQ(trail.version(), version);
  trail.burn({10e-3, 0.0}, 0.0, 1.0);  // the power follows the speed
  EXPECT_EQ(mean(), 0.0);
  trail.begin({{}, true});
  trail.burn({10e-3, 0.0}, 10e-3, 1e-3);
  EXPECT_TRUE(depths().empty()) << "no contour";
}

TEST_F(Trail, PiecesOfALongContourAreLonger) {
  geometry::Polyline line{{{0.0, 0.0}, {2.0, 0.0}}, false};
  trail.begin(line);
  EXPECT_EQ(depths().size(), DepthTrail::kMostPieces);
}

}  // namespace
}  // namespace telekerf::master
