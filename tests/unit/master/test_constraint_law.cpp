// SPDX-License-Identifier: Apache-2.0
// The laws of the constraint tick by tick, each against its closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "master/constraint/constraint_law.h"
#include "master/constraint/virtual_wall.h"
#include "tests/unit/master/contours.h"

namespace telekerf::master {
namespace {

constexpr double kDt_s = 1e-3;

/// On the x axis, travelled towards +x; y is across.
ActiveConstraint on_a_line(const Vec3& tool_m, double limit_m_per_s = 1e9) {
  ActiveConstraint active;
  active.phi_m = tool_m.y();
  active.limit = {limit_m_per_s, 0.0};
  return active;
}

ActiveConstraint on_a_circle(double radius_m, bool anticlockwise, const Vec3& tool_m) {
  ActiveConstraint active;
  active.piece.shape = geometry::osculating(Vec2(radius_m, 0), Vec2(0, anticlockwise ? 1 : -1),
                                            (anticlockwise ? 1 : -1) / radius_m);
  active.phi_m = active.piece.shape.phi(tool_m.head<2>());
  active.limit = {1e9, 0.0};
  return active;
}

TEST(VirtualWall, SetsInOverItsSkinAndIsCriticallyDamped) {
  constexpr double kSkin_m = 0.1e-3, kW = 100.0;
  const auto wall = [&](double a, double depth_m, double rate) {
    return virtual_wall_acceleration(a, depth_m, rate, kSkin_m, kW);
  };
  EXPECT_EQ(wall(3.0, -1e-3, 5.0), 3.0);
  EXPECT_EQ(wall(3.0, 0.0, 5.0), 3.0);
  EXPECT_NEAR(wall(3.0, 0.1e-3, 0.0), -1.0, 1e-12);
  EXPECT_NEAR(wall(3.0, 0.3e-3, 0.02), -3.0 - 4.0, 1e-12);
  EXPECT_NEAR(wall(3.0, 0.05e-3, 0.0), 0.5 * 3.0 - 0.5 * 0.5, 1e-12) << "half way in";
  EXPECT_NEAR(wall(3.0, 0.025e-3, 0.0), (1.0 - 0.15625) * 3.0 - 0.15625 * 0.25, 1e-12);
  EXPECT_EQ(wall(-7.0, 0.3e-3, 0.0), -7.0) << "it pushes, and never holds back";
  EXPECT_EQ(wall(-1.0, 0.3e-3, -0.1), -1.0);
}

// Sampled with a held acceleration, e obeys e[n+2] - (z1 + z2) e[n+1] + z1 z2 e[n] = 0, z = exp(p T).
TEST(Guidance, ASampledErrorDecaysByThePolesThatWereChosen) {
  for (const double damping : {0.6, 0.95, 1.0, 1.4}) {
    ConstraintSettings settings;
    settings.damping = damping;
    const double wt = settings.bandwidth_rad_s * kDt_s;
    const double decay = std::exp(-damping * wt);
    const double inner = wt * std::sqrt(std::abs(damping * damping - 1.0));
    const double sum = 2.0 * decay * (damping > 1.0 ? std::cosh(inner) : std::cos(inner));
    for (const bool upwards : {false, true}) {
      control::KinematicState tool;
      const Vec3 way = upwards ? Vec3::UnitZ() : Vec3::UnitY();
      tool.position_m = 20e-6 * way;
      tool.velocity_m_per_s = 1e-3 * way;
      double older = 0.0, old = 0.0;
      for (int n = 0; n < 30; ++n) {
        const double e = way.dot(tool.position_m);
        if (n >= 2) {
          EXPECT_NEAR(e - sum * old + decay * decay * older, 0.0, 1e-17) << damping << " " << n;
        }
        older = old;
        old = e;
        tool.acceleration_m_per_s2 =
            guided_acceleration(on_a_line(tool.position_m), settings, tool, Vec3::Zero());
        tool = control::advanced(tool, kDt_s);
      }
    }
  }
}

TEST(Guidance, TheWayBackIsAtTheSpeedThatWasSaidFromEitherSide) {
  const ConstraintSettings settings;
  for (const double side : {-1.0, 1.0}) {
    const KinematicState returning{
        {0, side * 5e-3, side * 5e-3}, {0, -side * 0.05, -side * 0.05}, Vec3::Zero()};
    EXPECT_NEAR(
        guided_acceleration(on_a_line(returning.position_m), settings, returning, Vec3::Zero()).norm(), 0.0,
        1e-9);
    const KinematicState slower{{0, side * 5e-3, 0}, {0, -side * 0.049, 0}, Vec3::Zero()};
    EXPECT_LT(side * guided_acceleration(on_a_line(slower.position_m), settings, slower, Vec3::Zero()).y(),
              -0.1);
  }
}

TEST(Guidance, OnACircleTheToolIsTurnedAsFastAsItRuns) {
  const ConstraintSettings settings;
  for (const bool anticlockwise : {false, true}) {
    for (const double speed : {-0.05, 0.03}) {
      const KinematicState tool{{5e-3, 0, 0}, {0, speed, 0}, Vec3::Zero()};
      const ActiveConstraint active = on_a_circle(5e-3, anticlockwise, tool.position_m);
      const Vec3 a = guided_acceleration(active, settings, tool, Vec3::Zero());
      EXPECT_NEAR(a.x(), -speed * speed / 5e-3, 1e-9) << anticlockwise;
      EXPECT_NEAR(a.y(), -settings.damping_n_s_per_m / settings.mass_kg * speed, 1e-9);
    }
  }
}

TEST(Guidance, ACircleThatMovesUnderTheToolIsAnErrorsVelocity) {
  const ConstraintSettings settings;
  ActiveConstraint active = on_a_line(Vec3::Zero());
  active.drift_m_per_s = 2e-3;
  const Vec3 drifting = guided_acceleration(active, settings, {}, Vec3::Zero());
  const KinematicState moving{Vec3::Zero(), {0, 2e-3, 0}, Vec3::Zero()};
  EXPECT_EQ(drifting.y(), guided_acceleration(on_a_line(Vec3::Zero()), settings, moving, Vec3::Zero()).y());
  EXPECT_LT(drifting.y(), -0.4);
  const ConstraintMode corridor{0.5e-3, 0.0};
  active.phi_m = 0.7e-3;  // beyond the wall, which must not move either
  const Vec3 a = region_acceleration(active, settings, corridor, {}, Vec3::Zero());
  EXPECT_NEAR(a.y(), -150.0 * 150.0 * 0.2e-3 - 2.0 * 150.0 * 2e-3, 1e-9);
}

TEST(Guidance, AReferenceIsFollowedInPlaceSpeedAndAcceleration) {
  const ConstraintSettings settings;
  const ConstraintReference reference{{0.2e-3, -0.1e-3}, {3e-3, 4e-3}, {0.5, 0.7}};
  const KinematicState on_it{{0, 0.2e-3, -0.1e-3}, {0, 3e-3, 4e-3}, Vec3::Zero()};
  const Vec3 a = guided_acceleration(on_a_line(on_it.position_m), settings, on_it, Vec3::Zero(), reference);
  EXPECT_LT((a - Vec3(0, 0.5, 0.7)).norm(), 1e-12);
}

TEST(Guidance, AlongTheCurveTheHandMovesTheVirtualMassLessDeadBandAndDamping) {
  const ConstraintSettings settings;
  for (const double way : {-1.0, 1.0}) {
    const auto a = [&](double force_n, double speed) {
      const KinematicState tool{Vec3::Zero(), {way * speed, 0, 0}, Vec3::Zero()};
      return way * guided_acceleration(on_a_line(Vec3::Zero()), settings, tool, {way * force_n, 0, 0}).x();
    };
    EXPECT_NEAR(a(1.0, 0.0), (1.0 - 0.15) / 0.5, 1e-12);
    EXPECT_EQ(a(0.149, 0.0), 0.0);
    EXPECT_NEAR(a(0.16, 0.0), 0.01 / 0.5, 1e-12);
    EXPECT_NEAR(a(1.0, 0.1), (0.85 - 0.2) / 0.5, 1e-12);
  }
}

TEST(Guidance, ABendHoldsTheToolBackEitherWayAndItsSlopeLeadsIntoItOnly) {
  const ConstraintSettings settings;
  for (const double way : {-1.0, 1.0}) {
    // `slope`: of the limit along the tool's own way.
    const auto a = [&](double speed, double slope, double force_n) {
      const KinematicState tool{Vec3::Zero(), {way * speed, 0, 0}, Vec3::Zero()};
      ActiveConstraint active = on_a_line(Vec3::Zero(), 0.02);
      active.limit.slope_per_s = way * slope;
      return way * guided_acceleration(active, settings, tool, {way * force_n, 0, 0}).x();
    };
    EXPECT_NEAR(a(0.02, 0.0, 5.0), 0.0, 1e-12) << "at the limit, whatever the hand does";
    EXPECT_NEAR(a(0.016, 0.0, 5.0), 250.0 * 0.004, 1e-12);
    EXPECT_NEAR(a(0.024, 0.0, 5.0), -250.0 * 0.004, 1e-12);
    EXPECT_NEAR(a(0.02, -10.0, 5.0), -10.0 * 0.02, 1e-12) << "the limit falls ahead";
    EXPECT_NEAR(a(0.02, 10.0, 5.0), 0.0, 1e-12) << "the limit rises";
    EXPECT_NEAR(a(0.01, 0.0, 1.0), (0.85 - 0.02) / 0.5, 1e-12) << "far below it nothing is felt";
    EXPECT_NEAR(a(0.02, 0.0, -5.0), (-4.85 - 0.04) / 0.5, 1e-12) << "nor by a hand that brakes";
  }
}

// What the slope is for: a tool that runs at the limit stays at it where it falls.
TEST(Guidance, AToolAtTheLimitBrakesAsTheLimitDoes) {
  const ConstraintSettings settings;
  const GuidePath guide = make_guide(testing::straight_line(0.05), 1.0, settings);
  for (const double way : {-1.0, 1.0}) {
    ConstraintGenerator generator;
    KinematicState tool{{0.025 + way * 5e-3, 0, 0}, Vec3::Zero(), Vec3::Zero()};
    tool.velocity_m_per_s.x() = way * guide.speed_limit(tool.position_m.x()).m_per_s;
    double worst_m_per_s = 0.0;
    for (int n = 0; n < 1000; ++n) {
      const ActiveConstraint active = generator.at(guide, tool.position_m.head<2>(), kDt_s);
      if (active.beyond_end_m != 0.0 || active.limit.m_per_s < 0.01) break;
      worst_m_per_s = std::max(worst_m_per_s, way * tool.velocity_m_per_s.x() - active.limit.m_per_s);
      tool.acceleration_m_per_s2 = guided_acceleration(active, settings, tool, {way * 5.0, 0, 0});
      EXPECT_GT(way * tool.acceleration_m_per_s2.x(), -1.1 * settings.slowing_m_per_s2);
      tool = control::advanced(tool, kDt_s);
    }
    EXPECT_LT(worst_m_per_s, 0.1e-3) << "3.2 mm/s, 0.8 m/s^2 over the rate of 250 1/s, if nothing led it";
    EXPECT_LT(way * tool.velocity_m_per_s.x(), 0.011);
  }
}

TEST(Guidance, AnEndIsAWallInItsOwnWay) {
  const ConstraintSettings settings;
  EXPECT_EQ(settings.end_bandwidth_rad_s, 300.0) << "as firm as the sides";
  for (const double side : {-1.0, 1.0}) {
    ActiveConstraint active = on_a_line(Vec3::Zero());
    active.beyond_end_m = side * 0.2e-3;
    const KinematicState outwards{Vec3::Zero(), {side * 2e-3, 0, 0}, Vec3::Zero()};
    EXPECT_NEAR(side * guided_acceleration(active, settings, outwards, {side * 3.0, 0, 0}).x(),
                -300.0 * 300.0 * 0.2e-3 - 2.0 * 300.0 * 2e-3, 1e-9);
    EXPECT_NEAR(side * guided_acceleration(active, settings, {}, {-side * 30.0, 0, 0}).x(), -29.85 / 0.5,
                1e-9)
        << "nothing holds the hand that pulls back";
    EXPECT_NEAR(side * region_acceleration(active, settings, {0.5e-3, 0.0}, {}, {side * 3.0, 0, 0}).x(),
                -300.0 * 300.0 * 0.2e-3, 1e-9)
        << "in a corridor as well";
  }
}

TEST(Region, HandMovesTheMassAcrossAndAlongAndNoBendHoldsIt) {
  const ConstraintSettings settings;
  const ConstraintMode mode{0.5e-3, 0.0};
  const KinematicState tool{{0, 0.1e-3, 0}, {0.03, 0.01, 0}, Vec3::Zero()};
  ActiveConstraint active = on_a_line(tool.position_m, 1e-3);
  const Vec3 a = region_acceleration(active, settings, mode, tool, {1.0, -2.0, 5.0});
  EXPECT_NEAR(a.x(), (0.85 - 2.0 * 0.03) / 0.5, 1e-12);
  EXPECT_NEAR(a.y(), (-1.85 - 2.0 * 0.01) / 0.5, 1e-12);
  EXPECT_EQ(a.z(), 0.0);
  EXPECT_EQ(region_acceleration(active, settings, mode, {}, {0.1, 0.1, 0}).norm(), 0.0)
      << "less than is felt";
  const KinematicState above{{0, 0, 30e-6}, {0, 0, 1e-3}, Vec3::Zero()};
  EXPECT_EQ(region_acceleration(on_a_line(Vec3::Zero()), settings, mode, above, Vec3::Zero()).z(),
            guided_acceleration(on_a_line(Vec3::Zero()), settings, above, Vec3::Zero()).z())
      << "height is held as ever";
}

TEST(Region, AWallStandsToEitherSide) {
  const ConstraintSettings settings;
  const ConstraintMode mode{0.5e-3, 0.0};
  for (const double side : {-1.0, 1.0}) {
    const auto a = [&](double off_m, double rate, double force_n) {
      const KinematicState tool{{0, side * off_m, 0}, {0, side * rate, 0}, Vec3::Zero()};
      return side *
             region_acceleration(on_a_line(tool.position_m), settings, mode, tool, {0, side * force_n, 0})
                 .y();
    };
    EXPECT_NEAR(a(0.5e-3, 0.0, 3.0), 2.85 / 0.5, 1e-9);
    EXPECT_NEAR(a(0.55e-3, 0.0, 3.0), -150.0 * 150.0 * 0.05e-3, 1e-9) << "all there behind its skin";
    EXPECT_NEAR(a(0.6e-3, 0.01, 3.0), -150.0 * 150.0 * 0.1e-3 - 2.0 * 150.0 * 0.01, 1e-9);
  }
}

// Released off the curve: critically damped by the spring and the virtual mass, whatever drag there is else.
TEST(Region, TheSpringComesBackWithoutOvershoot) {
  ConstraintSettings settings;
  settings.damping_n_s_per_m = 0.0;
  const ConstraintMode mode{0.5e-3, 1000.0};
  const double w = std::sqrt(mode.stiffness_n_per_m / settings.mass_kg);
  constexpr double kFine_s = 1e-5, kOff_m = 0.3e-3;
  KinematicState tool{{0, kOff_m, 0}, Vec3::Zero(), Vec3::Zero()};
  double overshoot_m = 0.0;
  for (int n = 0; n < 20000; ++n) {
    const double wt = w * n * kFine_s;
    ASSERT_NEAR(tool.position_m.y(), kOff_m * (1.0 + wt) * std::exp(-wt), 0.005 * kOff_m) << n;
    overshoot_m = std::max(overshoot_m, -tool.position_m.y());
    tool.acceleration_m_per_s2 =
        region_acceleration(on_a_line(tool.position_m), settings, mode, tool, Vec3::Zero());
    tool = control::advanced(tool, kFine_s);
  }
  EXPECT_LT(overshoot_m, 1e-9);
}

}  // namespace
}  // namespace telekerf::master
