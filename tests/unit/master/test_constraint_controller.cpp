// SPDX-License-Identifier: Apache-2.0
// Which circle is in force, and what passes between the forms of the constraint.
#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/minimum_jerk.h"
#include "master/constraint/constraint_controller.h"
#include "tests/unit/master/contours.h"

namespace telekerf::master {
namespace {

using namespace testing;

constexpr double kDt_s = 1e-3;

Vec2 on_circle(double radius_m, double arc_m) {
  return radius_m * Vec2(std::cos(arc_m / 0.01), std::sin(arc_m / 0.01));
}

TEST(ConstraintGenerator, ALostFootPointIsFoundAgainInOneCallHoweverFarTheToolJumped) {
  const GuidePath guide = make_guide(circle(0.01), 1.0, {});
  const double scale = guide.length_m() / (2.0 * M_PI * 0.01);
  for (const double jump_m : {1e-6, 0.2e-3, 0.49e-3, 0.7e-3, 1e-3, 1.5e-3, 2e-3, 3e-3, 5e-3, 8e-3}) {
    for (const double way : {-1.0, 1.0}) {
      for (const double radius_m : {0.006, 0.0095, 0.01, 0.012}) {
        ConstraintGenerator generator;
        const double start_m = 7e-3;
        generator.at(guide, on_circle(radius_m, start_m), kDt_s);
        const ActiveConstraint active =
            generator.at(guide, on_circle(radius_m, start_m + way * jump_m), kDt_s);
        const double off_m =
            std::remainder(active.piece.arc_m - (start_m + way * jump_m) * scale, guide.length_m());
        EXPECT_NEAR(off_m, 0.0, 0.5e-6) << jump_m << " " << way << " at " << radius_m;
        EXPECT_NEAR(active.phi_m, 0.01 - radius_m, 2e-6);
      }
    }
  }
}

TEST(ConstraintGenerator, TheDriftIsWhatTheNewCircleChangesAtTheTool) {
  const GuidePath guide = make_guide(figure_eight(), 1.0, {});
  ConstraintGenerator generator;
  GuidePiece last;
  double largest = 0.0;
  for (int n = 0; n < 3000; ++n) {
    const auto at = guide.curve.at(5e-3 + 20e-6 * n);  // not from the crossing
    const Vec2 tool = at.point_m + 0.3e-3 * Vec2(-at.tangent.y(), at.tangent.x());
    const ActiveConstraint active = generator.at(guide, tool, kDt_s);
    EXPECT_EQ(active.phi_m, active.piece.shape.phi(tool));
    const double changed = n == 0 ? 0.0 : (active.phi_m - last.shape.phi(tool)) / kDt_s;
    ASSERT_NEAR(active.drift_m_per_s, changed, 1e-15) << n;
    largest = std::max(largest, std::abs(changed));
    last = active.piece;
  }
  EXPECT_GT(largest, 1.5e-5);
  // And never faster than a curve can move: the foot point has jumped.
  for (const double far_m : {-5e-3, 5e-3}) {
    generator.reset();
    generator.at(guide, Vec2(0.01, 0.0), kDt_s);
    const ActiveConstraint jumped = generator.at(guide, Vec2(-0.01, far_m), kDt_s);
    EXPECT_NEAR(std::abs(jumped.drift_m_per_s), 0.05, 1e-12);
  }
  generator.reset();
  EXPECT_EQ(generator.at(guide, Vec2(0.0, 0.0), kDt_s).drift_m_per_s, 0.0) << "afresh";
  EXPECT_EQ(generator.at(guide, Vec2(1e-5, 1e-4), 0.0).drift_m_per_s, 0.0) << "no time has passed";
}

TEST(ConstraintGenerator, PastHalfTheRadiusAWiderCircleStandsForTheCurve) {
  const GuidePath guide = make_guide(circle(0.01), 1.0, {});
  const double radius_m = guide.at(0.0).shape.radius_m;
  const Vec2 foot = guide.at(0.0).point_m;
  for (const double off_m : {-20e-3, -5e-3, 4.9e-3, 5.1e-3, 8e-3, 15e-3}) {
    ConstraintGenerator generator;
    const ActiveConstraint active = generator.at(guide, foot, kDt_s);
    EXPECT_NEAR(active.piece.shape.radius_m, radius_m, 1e-9);
    const Vec2 tool = foot - Vec2(off_m, 0.0);
    const ActiveConstraint torn = generator.at(guide, tool, kDt_s);
    EXPECT_NEAR(torn.piece.shape.radius_m, std::max(radius_m, 2.0 * off_m), 1e-6) << off_m;
    EXPECT_NEAR(torn.phi_m, off_m, 1e-9) << off_m;
    EXPECT_LT((torn.piece.shape.tangent(tool) - Vec2(0, 1)).norm(), 1e-6);
    EXPECT_LT((torn.piece.point_m - foot).norm(), 1e-6);
  }
}

TEST(ConstraintGenerator, BeyondAnEndIsBeyondItBySoMuch) {
  const GuidePath guide = make_guide(straight_line(0.01), 1.0, {});
  for (const double x : {-0.5e-3, -1e-6, 1e-6, 5e-3, 9.999e-3, 10.001e-3, 10.4e-3}) {
    ConstraintGenerator generator;
    const double expected = x < 0.0 ? x : std::max(0.0, x - 0.01);
    for (int n = 0; n < 3; ++n) {
      const ActiveConstraint active = generator.at(guide, Vec2(x, 0.1e-3), kDt_s);
      EXPECT_NEAR(active.beyond_end_m, expected, 1e-9) << x;
      EXPECT_NEAR(active.limit.m_per_s, guide.speed_limit(std::clamp(x, 0.0, 0.01)).m_per_s, 1e-9) << x;
      EXPECT_NEAR(active.phi_m, 0.1e-3, 1e-9);
    }
  }
}

/// A tool that does what is asked for; the signed distance to the circle of 10 mm, outwards.
struct IdealTool {
  explicit IdealTool(double off_m, double outwards_m_per_s = 0.0, double up_m = 0.0)
      : state{{0.01 + off_m, 0, up_m}, {outwards_m_per_s, 0, 0}, Vec3::Zero()} {}
  void follow(const Vec3& wanted) {
    state.acceleration_m_per_s2 = wanted;
    state = control::advanced(state, kDt_s);
  }
  double off_m(const GuidePath& guide) const {
    return state.position_m.head<2>().norm() - guide.at(0.0).shape.radius_m;
  }
  KinematicState state;
};

TEST(Entry, RunsByAQuinticFromThePlaceAndSpeedOfTheTool) {
  ConstraintSettings settings;
  const GuidePath guide = make_guide(circle(0.01), 1.0, settings);
  struct Case {
    double off_m;
    double outwards_m_per_s;
    double up_m;
    double duration_s;
  };
  for (const Case& entry :
       {Case{0.4e-3, 0.0, 0.0, 0.3}, Case{-0.4e-3, 0.0, 0.3e-3, 0.3},
        Case{0.2e-3, 0.02, 0.0, 0.25e-3 / (0.184 * 0.02)},
        Case{-0.2e-3, 0.02, 0.1e-3, 0.25e-3 / (0.184 * 0.02)}, Case{0.1e-3, 0.2, 0.0, 0.03},
        Case{10e-3, 0.0, 0.0, 1.875 * 10e-3 / 0.05}, Case{0.0, 0.0, 12e-3, 1.875 * 12e-3 / 0.05}}) {
    ConstraintController controller(settings);
    IdealTool tool(entry.off_m + guide.at(0.0).shape.radius_m - 0.01, entry.outwards_m_per_s, entry.up_m);
    for (int n = 0; n * kDt_s < entry.duration_s + 0.02; ++n) {
      const double u = std::min(1.0, n * kDt_s / entry.duration_s);
      const double left = 1.0 - geometry::minimum_jerk(u).place;
      const double run = u - 6.0 * std::pow(u, 3) + 8.0 * std::pow(u, 4) - 3.0 * std::pow(u, 5);
      const double expected_m = left * entry.off_m + run * entry.duration_s * entry.outwards_m_per_s;
      // Accelerations that are held over a tick lag behind a quintic.
      const double tolerance_m =
          1e-6 + 5e-3 * std::abs(entry.off_m) + 2e-3 * entry.outwards_m_per_s * entry.outwards_m_per_s;
      ASSERT_NEAR(tool.off_m(guide), expected_m, tolerance_m) << n << " from " << entry.off_m;
      ASSERT_NEAR(tool.state.position_m.z(), left * entry.up_m, 0.2e-6 + 5e-3 * entry.up_m) << n;
      tool.follow(controller.step(guide, tool.state, Vec3::Zero(), kDt_s));
    }
  }
}

TEST(Entry, OneThatTakesNoTimeIsADecayFromTheStart) {
  ConstraintSettings settings;
  settings.entry_s = 0.0;
  const GuidePath guide = make_guide(circle(0.01), 1.0, settings);
  ConstraintController controller(settings);
  const IdealTool tool(0.1e-3);
  ConstraintGenerator generator;
  const ActiveConstraint active = generator.at(guide, tool.state.position_m.head<2>(), kDt_s);
  EXPECT_EQ(controller.step(guide, tool.state, Vec3::Zero(), kDt_s),
            guided_acceleration(active, settings, tool.state, Vec3::Zero()));
}

TEST(Entry, AToolThatIsTooFastForTheBendIsSlowedDownGently) {
  ConstraintSettings settings;
  const GuidePath guide = make_guide(circle(1e-3), 1.0, settings);
  const double limit = guide.speed_limit(0.0).m_per_s;
  EXPECT_LT(limit, 0.032);
  for (const double way : {-1.0, 1.0}) {
    ConstraintController controller(settings);
    const double radius_m = guide.at(0.0).shape.radius_m;
    for (int n = 0; n < 60; ++n) {
      const KinematicState tool{{radius_m, 0, 0}, {0, way * (limit + 0.04), 0}, Vec3::Zero()};
      (void)controller.step(guide, tool, Vec3::Zero(), kDt_s);
      const double left = std::max(0.0, 0.04 - settings.bend_m_per_s2 * (n + 1) * kDt_s);
      EXPECT_NEAR(controller.active().limit.m_per_s, limit + left, 1e-6) << n;
    }
  }
}

TEST(Entry, AToolThatNobodyMovesIsHeldWhereItCameToRest) {
  const ConstraintSettings settings;
  const GuidePath guide = make_guide(straight_line(0.05), 1.0, settings);
  ConstraintController controller(settings);
  // The hold alone: what is asked for along the curve less the virtual damping's.
  const auto hold = [&](double x, double speed, double force_n) {
    const KinematicState tool{{0.02 + x, 0, 0}, {speed, 0, 0}, Vec3::Zero()};
    const double a = controller.step(guide, tool, {force_n, 0, 0}, kDt_s).x();
    const double force = force_n - std::clamp(force_n, -0.15, 0.15);
    return a - (force - settings.damping_n_s_per_m * speed) / settings.mass_kg;
  };
  EXPECT_NEAR(hold(0.0, 0.0, 0.0), 0.0, 1e-9);
  EXPECT_NEAR(hold(10e-6, 0.0, 0.0), -1600.0 * 10e-6, 1e-9);
  EXPECT_NEAR(hold(-5e-6, 0.5e-3, 0.1), 1600.0 * 5e-6 - 80.0 * 0.5e-3, 1e-9);
  EXPECT_NEAR(hold(20e-6, -0.9e-3, -0.14), -1600.0 * 20e-6 + 80.0 * 0.9e-3, 1e-9);
  EXPECT_NEAR(hold(20e-6, 0.0, 0.16), 0.0, 1e-9) << "a hand is felt";
  EXPECT_NEAR(hold(30e-6, 0.0, 0.0), 0.0, 1e-9) << "a new place of rest";
  EXPECT_NEAR(hold(31e-6, 0.0, 0.0), -1600.0 * 1e-6, 1e-9);
  EXPECT_NEAR(hold(40e-6, 1.1e-3, 0.0), 0.0, 1e-9) << "it runs";
  EXPECT_NEAR(hold(50e-6, 0.0, -0.16), 0.0, 1e-9);
  EXPECT_NEAR(hold(60e-6, 0.0, 0.0), 0.0, 1e-9);
  EXPECT_NEAR(hold(60e-6, -1.1e-3, 0.0), 0.0, 1e-9);
  controller.set_mode({0.5e-3, 0.0});
  for (int n = 0; n < 400; ++n) (void)hold(60e-6, 0.0, 0.0);
  EXPECT_NEAR(hold(90e-6, 0.0, 0.0), 0.0, 1e-9) << "a corridor holds nothing";
  controller.set_mode({});
  EXPECT_NEAR(hold(100e-6, 0.0, 0.0), 0.0, 1e-9) << "nor does a place from before it";
}

TEST(Entry, AnOpenedCorridorGivesItsFreedomByAShareThatGrowsSmoothly) {
  const ConstraintSettings settings;
  const GuidePath guide = make_guide(straight_line(0.05), 1.0, settings);
  const Vec3 push(0.0, 1.15, 0.0);
  const double free = 1.0 / settings.mass_kg;
  const KinematicState tool{{0.02, 0, 0}, Vec3::Zero(), Vec3::Zero()};
  ConstraintController controller(settings);
  (void)controller.step(guide, tool, push, kDt_s);
  EXPECT_NEAR(controller.step(guide, tool, push, kDt_s).y(), 0.0, 1e-9) << "guided";
  controller.set_mode({0.5e-3, 0.0});
  for (int n = 1; n <= 320; ++n) {
    const double share = geometry::minimum_jerk(std::min(1.0, n * kDt_s / settings.entry_s)).place;
    EXPECT_NEAR(controller.step(guide, tool, push, kDt_s).y(), share * free, 1e-6) << n;
  }
  // A wider corridor is no opening, and neither is one from the start.
  controller.set_mode({1e-3, 0.0});
  EXPECT_NEAR(controller.step(guide, tool, push, kDt_s).y(), free, 1e-9);
  ConstraintController fresh(settings);
  fresh.set_mode({0.5e-3, 0.0});
  EXPECT_NEAR(fresh.step(guide, tool, push, kDt_s).y(), free, 1e-9);
  EXPECT_EQ(fresh.mode().corridor_m, 0.5e-3);
}

TEST(Entry, EnteringStartsOnTheNearestCurveAgain) {
  const ConstraintSettings settings;
  const GuidePath guide = make_guide(figure_eight(), 1.0, settings);
  ConstraintController controller(settings);
  const auto arc_at = [&](const Vec2& tool) {
    const KinematicState at{{tool.x(), tool.y(), 0}, Vec3::Zero(), Vec3::Zero()};
    (void)controller.step(guide, at, Vec3::Zero(), kDt_s);
    return controller.active().piece.arc_m;
  };
  const Vec2 right = guide.at(0.25 * guide.length_m()).point_m;
  const Vec2 left = guide.at(0.75 * guide.length_m()).point_m;
  EXPECT_NEAR(arc_at(right), 0.25 * guide.length_m(), 1e-6);
  controller.enter();
  EXPECT_NEAR(arc_at(left), 0.75 * guide.length_m(), 1e-6);
  EXPECT_EQ(controller.active().drift_m_per_s, 0.0);
}

}  // namespace
}  // namespace telekerf::master
