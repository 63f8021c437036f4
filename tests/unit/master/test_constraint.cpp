// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/runtime/startup_error.h"
#include "master/constraint/constraint_controller.h"
#include "tests/unit/master/contours.h"

namespace telekerf::master {
namespace {

using namespace testing;

/// One step of the generator without memory.
ActiveConstraint fresh(const GuidePath& guide, const Vec2& tool) {
  ConstraintGenerator generator;
  return generator.at(guide, tool, 1e-3);
}

TEST(GuidePath, IsTheContourOverBeta) {
  const GuidePath guide = make_guide(circle(0.01), 0.5, {});
  EXPECT_EQ(guide.contour_id, 3u);
  for (const auto& point : guide.curve.line().points_m) EXPECT_NEAR(point.norm(), 0.02, 3e-6);
  const GuidePiece piece = guide.at(0.01);
  EXPECT_NEAR(piece.shape.radius_m, 0.02, 2e-5);
  EXPECT_LT(piece.shape.centre_m.norm(), 2e-5);
}

TEST(GuidePath, EveryKindOfCurveStandsForTheCircle) {
  for (const CurveKind curve : {CurveKind::kCircles, CurveKind::kLines, CurveKind::kDescriptor}) {
    ConstraintSettings settings;
    settings.curve = curve;
    const GuidePath guide = make_guide(circle(0.01), 1.0, settings);
    for (int i = 0; i < 50; ++i) {
      const GuidePiece piece = guide.at(guide.length_m() * i / 50);
      EXPECT_NEAR(piece.point_m.norm(), 0.01, 12e-6) << static_cast<int>(curve);
      EXPECT_NEAR(std::abs(piece.shape.tangent(piece.point_m).dot(piece.point_m.normalized())), 0.0, 2e-3);
    }
  }
}

TEST(GuidePath, CirclesLeaveLessContourErrorThanLinesForEveryK) {
  for (const int k : {2, 4, 8, 16, 32}) {
    double worst[2] = {0.0, 0.0};
    for (const bool lines : {false, true}) {
      ConstraintSettings settings;
      settings.curve = lines ? CurveKind::kLines : CurveKind::kCircles;
      settings.half_window = k;
      settings.spacing_m = 0.1e-3;
      settings.rounding_m = 0.0;
      const GuidePath guide = make_guide(figure_eight(), 1.0, settings);
      for (int i = 0; i < 500; ++i) {
        const Vec2 on_guide = guide.at(guide.length_m() * i / 500).point_m;
        worst[lines] = std::max(worst[lines], guide.curve.find(on_guide).distance_m);
      }
    }
    EXPECT_LT(worst[0], worst[1]) << "k = " << k;
  }
}

TEST(GuidePath, CircleChangesContinuouslyWithTheArcSoThatNoHandoverIsAnEvent) {
  const GuidePath guide = make_guide(figure_eight(), 1.0, {});
  constexpr double kStep = 1e-6;
  double largest = 0.0;
  for (double arc = 0.0; arc < guide.length_m(); arc += 3.7e-6) {
    const Vec2 tool = guide.at(arc).point_m + Vec2(20e-6, -10e-6);
    largest =
        std::max(largest, std::abs(guide.at(arc + kStep).shape.phi(tool) - guide.at(arc).shape.phi(tool)));
  }
  EXPECT_LT(largest, 4e-9);
}

TEST(GuidePath, SlowsDownAheadOfBendsAsHardAsItMay) {
  ConstraintSettings settings;
  ContourMessage square;
  for (const auto& p : {Vec2(0, 0), Vec2(0.02, 0), Vec2(0.02, 0.02), Vec2(0, 0.02)})
    square.points_m.push_back(p);
  const GuidePath guide = make_guide(square, 1.0, settings);
  double least = 1.0;
  for (double arc = 0.0; arc < guide.length_m(); arc += 20e-6) {
    const auto limit = guide.speed_limit(arc);
    least = std::min(least, limit.m_per_s);
    EXPECT_LE(std::abs(limit.m_per_s * limit.slope_per_s), 1.2 * settings.slowing_m_per_s2);
  }
  EXPECT_NEAR(least, 0.727e-3, 0.01e-3);
  EXPECT_NEAR(guide.speed_limit(0.01).m_per_s, std::sqrt(2 * settings.slowing_m_per_s2 * 0.01), 0.01);
}

TEST(GuidePath, RefusesADescriptorOfAnOpenContour) {
  ContourMessage open = circle(0.01);
  open.closed = false;
  ConstraintSettings settings;
  settings.curve = CurveKind::kDescriptor;
  EXPECT_THROW(make_guide(open, 1.0, settings), StartupError);
}

// A point mass that obeys the acceleration exactly, integrated finely, must show eq. 65's decay.
TEST(Constraint, ErrorDecaysAsEq65SaysWhileTheToolRunsRoundTheCircle) {
  constexpr double kDt = 1e-5;
  ConstraintSettings settings;
  settings.period_s = kDt;
  const GuidePath guide = make_guide(circle(0.01), 1.0, settings);
  ConstraintGenerator generator;
  const double w = settings.bandwidth_rad_s;
  const double start = 0.3e-3;
  Vec3 x(0.01 + start, 0, start);
  Vec3 v(0, 0.03, 0);
  for (int n = 0; n < 5000; ++n) {
    const auto active = generator.at(guide, x.head<2>(), kDt);
    const Vec3 a = guided_acceleration(active, settings, {x, v}, Vec3::Zero());
    v += a * kDt;
    x += v * kDt;
    const double t = (n + 1) * kDt;
    const double expected = start * (1.0 + w * t) * std::exp(-w * t);
    EXPECT_NEAR(x.head<2>().norm() - 0.01, expected, 0.02 * start) << t;
    EXPECT_NEAR(x.z(), expected, 0.02 * start) << t;
  }
}

TEST(Constraint, FarFromTheCurveTheToolReturnsNoFasterThanSaid) {
  constexpr double kDt = 1e-4;
  ConstraintSettings settings;
  settings.period_s = kDt;
  const GuidePath guide = make_guide(circle(0.01), 1.0, settings);
  ConstraintGenerator generator;
  Vec3 x(0.015, 0, 0);
  Vec3 v = Vec3::Zero();
  double fastest = 0.0;
  double beyond = 0.0;
  for (int n = 0; n < 5000; ++n) {
    v += guided_acceleration(generator.at(guide, x.head<2>(), kDt), settings, {x, v}, Vec3::Zero()) * kDt;
    x += v * kDt;
    fastest = std::max(fastest, v.norm());
    beyond = std::max(beyond, 0.01 - x.head<2>().norm());
  }
  EXPECT_NEAR(fastest, settings.return_m_per_s, 0.02 * settings.return_m_per_s);
  EXPECT_LT(beyond, 1e-6) << "and does not overshoot";
}

TEST(Constraint, TheHandMovesTheVirtualMassAlongAndNothingAcross) {
  ConstraintSettings settings;
  const GuidePath guide = make_guide(circle(0.01), 1.0, settings);
  const auto active = fresh(guide, {0.01, 0});
  const Vec3 along = guided_acceleration(active, settings, {{0.01, 0, 0}, Vec3::Zero()}, {0, 1.0, 0});
  EXPECT_NEAR(along.y(), (1.0 - settings.force_deadband_n) / settings.mass_kg, 1e-2);
  const Vec3 across = guided_acceleration(active, settings, {{0.01, 0, 0}, Vec3::Zero()}, {3.0, 0, 2.0});
  EXPECT_LT(across.norm(), 0.1);
}

TEST(Constraint, AtACrossingTheToolStaysOnItsBranch) {
  const GuidePath guide = make_guide(figure_eight(), 1.0, {});
  ConstraintGenerator generator;
  double before = -1.0;
  const double length = guide.length_m();
  // From the tip of one lobe, so that the first search has no choice, through the crossing twice.
  for (int i = 0; i <= 4000; ++i) {
    const double arc = length * (0.25 + 0.74 * i / 4000.0);
    // The hand strays 0.2 mm to the left of the curve all along.
    const auto at = guide.curve.at(arc);
    const Vec2 tool = at.point_m + 0.2e-3 * Vec2(-at.tangent.y(), at.tangent.x());
    const double found = generator.at(guide, tool, 1e-3).piece.arc_m;
    if (before >= 0.0) {
      EXPECT_LT(std::abs(found - before), 20e-6) << "at arc " << arc;
    }
    before = found;
  }
}

TEST(Constraint, AnOpenCurveEndsInASoftStopThatLetsTheToolBack) {
  ConstraintSettings settings;
  const GuidePath guide = make_guide(straight_line(0.01), 1.0, settings);
  const auto beyond = fresh(guide, {0.0102, 0.0});
  EXPECT_NEAR(beyond.beyond_end_m, 0.2e-3, 1e-6);
  const Vec3 pushed = guided_acceleration(beyond, settings, {{0.0102, 0, 0}, Vec3::Zero()}, {3.0, 0, 0});
  EXPECT_LT(pushed.x(), 0.0);
  const auto inside = fresh(guide, {0.0098, 0.0});
  EXPECT_EQ(inside.beyond_end_m, 0.0);
  const Vec3 back = guided_acceleration(inside, settings, {{0.0098, 0, 0}, Vec3::Zero()}, {-3.0, 0, 0});
  EXPECT_LT(back.x(), -1.0);
  const Vec3 away = guided_acceleration(beyond, settings, {{0.0102, 0, 0}, Vec3::Zero()}, {-3.0, 0, 0});
  EXPECT_LE(away.x(), -3.0) << "the stop does not hold the hand that pulls back";
}

TEST(Region, IsFreeInsideStiffAtTheWallAndDoesNotStick) {
  ConstraintSettings settings;
  settings.damping_n_s_per_m = 0.0;
  const ConstraintMode form{0.5e-3, 0.0};
  const GuidePath guide = make_guide(circle(0.01), 1.0, settings);
  const auto across = [&](double radius, double push) {
    const Vec3 x(radius, 0, 0);
    return region_acceleration(fresh(guide, x.head<2>()), settings, form, {x, Vec3::Zero()}, {push, 0, 0})
        .x();
  };
  const double free = (1.0 - settings.force_deadband_n) / settings.mass_kg;
  EXPECT_NEAR(across(0.01, 1.0), free, 0.01);
  EXPECT_NEAR(across(0.0103, 1.0), free, 0.01) << "inside";
  EXPECT_LT(across(0.0107, 3.0), -1.0) << "outside, whatever the hand does";
  EXPECT_LE(across(0.0107, -1.0), -free + 0.01) << "nothing holds the hand that pulls back";
  EXPECT_LT(std::abs(across(0.0105 + 1e-7, 1.0) - across(0.0105 - 1e-7, 1.0)), 0.01) << "sets in gradually";
}

TEST(Region, SpringBlendsBetweenFreeAndGuided) {
  ConstraintSettings settings;
  const GuidePath guide = make_guide(circle(0.01), 1.0, settings);
  double before = 1.0;
  for (const double stiffness : {0.0, 100.0, 1000.0, 10000.0}) {
    const Vec3 x(0.0103, 0, 0);
    const double a = region_acceleration(fresh(guide, x.head<2>()), settings, {0.5e-3, stiffness},
                                         {x, Vec3::Zero()}, Vec3::Zero())
                         .x();
    EXPECT_NEAR(a, -stiffness * 0.3e-3 / settings.mass_kg, 0.05 + 0.02 * stiffness * 1e-3);
    EXPECT_LT(a, before);
    before = a;
  }
}

TEST(Entry, FromHalfAMillimetreOffNothingJumps) {
  ConstraintSettings settings;
  const GuidePath guide = make_guide(circle(0.01), 1.0, settings);
  ConstraintController controller(settings);
  controller.set_mode({0.5e-3, 0.0});
  Vec3 x(0.0104, 0, 0);
  Vec3 v = Vec3::Zero();
  constexpr double kDt = 1e-3;
  double largest_step = 0.0;
  for (int n = 0; n < 1000; ++n) {
    if (n == 100) controller.set_mode({});
    const Vec3 a = controller.step(guide, {x, v}, Vec3::Zero(), kDt);
    largest_step = std::max(largest_step, a.norm() * kDt);
    v += a * kDt;
    x += v * kDt;
    if (n == 99) {
      EXPECT_NEAR(x.x(), 0.0104, 1e-6) << "free";
    }
  }
  EXPECT_NEAR(largest_step, 25.6e-6, 1e-6);
  EXPECT_NEAR(x.head<2>().norm(), 0.01, 2e-6) << "rounding moves a circle inwards by sigma^2 / 2R";
}

// Closed and opened while the hand drives the tool sideways: the velocity across that is asked for goes on
// from the tool's own, and nothing later asks for more than a gentle brake.
TEST(Entry, ACorridorClosesAndOpensUnderAMovingHandWithoutAJump) {
  ConstraintSettings settings;
  const GuidePath guide = make_guide(circle(0.01), 1.0, settings);
  constexpr double kDt = 1e-3;
  for (const double sideways : {-0.05, -0.02, 0.0, 0.02, 0.05}) {
    ConstraintController controller(settings);
    controller.set_mode({0.5e-3, 0.0});
    Vec3 x(0.0102, 0, 0);
    Vec3 v = Vec3::Zero();
    Vec3 push = Vec3::Zero();
    double largest = 0.0;
    double farthest = 0.0;
    double before = 0.0;
    double largest_opening_step = 0.0;
    int opening_ticks = 0;
    for (int n = 0; n < 1600; ++n) {
      const Vec3 radial(x.x() / x.head<2>().norm(), x.y() / x.head<2>().norm(), 0);
      if (n == 5) v = sideways * radial + Vec3(0, 0.01, 0);
      if (n == 6) controller.set_mode({});
      if (n == 1000) push = 3.0 * radial;
      if (n == 1200) controller.set_mode({0.5e-3, 0.0});
      const Vec3 a = controller.step(guide, {x, v}, push, kDt);
      const Vec3 around(-radial.y(), radial.x(), 0);
      const double across = a.dot(radial) + v.dot(around) * v.dot(around) / x.head<2>().norm();
      if (n == 6) {
        EXPECT_LT(std::abs(across) * kDt, 1e-9) << "in the tick of closing, from " << sideways << " m/s";
      }
      if (n >= 6 && n < 1000) {
        largest = std::max(largest, std::abs(across));
        farthest = std::max(farthest, std::abs(x.head<2>().norm() - 0.01));
      }
      const bool at_the_wall = std::abs(x.head<2>().norm() - 0.01) > 0.45e-3;
      if (n >= 1200 && !at_the_wall) {
        largest_opening_step = std::max(largest_opening_step, std::abs(across - before) * kDt);
        ++opening_ticks;
      } else if (n >= 1200) {
        break;  // whatever the wall does now
      }
      before = across;
      v += a * kDt;
      x += v * kDt;
      if (n == 999) {
        EXPECT_NEAR(x.head<2>().norm(), 0.01, 5e-6) << "closed";
      }
    }
    EXPECT_LT(largest, 8.8) << sideways;
    EXPECT_LT(farthest, 0.5e-3) << "not much beyond where it was, and not through the other side";
    EXPECT_NEAR(largest_opening_step, 8.3e-6, 0.2e-6) << "freedom comes gradually";
    EXPECT_EQ(opening_ticks, 181);
    EXPECT_GT(x.head<2>().norm(), 0.0104) << "and then the hand moves it";
  }
}

TEST(GuidePath, NoBendIsTighterThanSaidAndTipsLoseLittle) {
  ConstraintSettings settings;
  ContourMessage star;
  for (int i = 0; i < 10; ++i) {
    const double r = i % 2 == 0 ? 0.02 : 0.008;
    star.points_m.emplace_back(r * std::cos(i * M_PI / 5), r * std::sin(i * M_PI / 5));
  }
  ContourMessage hairpin;  // there and back again on the same line
  for (int i = 0; i <= 200; ++i) hairpin.points_m.emplace_back((i <= 100 ? i : 200 - i) * 1e-4, 0.0);
  for (const auto& contour : {star, hairpin}) {
    const GuidePath guide = make_guide(contour, 1.0, settings);
    double tightest = 1.0;
    for (double arc = 0.0; arc < guide.length_m(); arc += 7e-6) {
      const auto& shape = guide.at(arc).shape;
      if (!shape.is_line) tightest = std::min(tightest, shape.radius_m);
    }
    EXPECT_GE(tightest, 0.999 * settings.min_radius_m);
    const double lost_m = settings.opening_m + settings.rounding_m + 2.0 * settings.spacing_m;
    for (const auto& point : contour.points_m) EXPECT_LT(guide.curve.find(point).distance_m, lost_m);
  }
  const GuidePath guide = make_guide(star, 1.0, settings);
  for (const auto& point : star.points_m) EXPECT_LT(guide.curve.find(point).distance_m, 0.145e-3);
}

TEST(GuidePath, AnOpenCurveIsSlowAtItsEnds) {
  ConstraintSettings settings;
  const GuidePath guide = make_guide(straight_line(0.01), 1.0, settings);
  EXPECT_EQ(guide.speed_limit(0.0).m_per_s, settings.end_m_per_s);
  EXPECT_EQ(guide.speed_limit(guide.length_m()).m_per_s, settings.end_m_per_s);
  EXPECT_GT(guide.speed_limit(0.005).m_per_s, 0.05);
}

// The hand tears the tool far to the inner side of a bend, past the centre of its circle.
TEST(Constraint, TheToolComesBackToTheCurveAndNotToTheFarSideOfACircle) {
  constexpr double kDt = 1e-3;
  ConstraintSettings settings;
  ContourMessage stadium;  // two half circles of 1 mm, 10 mm apart
  for (int i = 0; i <= 180; ++i) {
    const double a = -M_PI / 2 + i * M_PI / 180;
    stadium.points_m.emplace_back(5e-3 + 1e-3 * std::cos(a), 1e-3 * std::sin(a));
  }
  for (int i = 0; i <= 180; ++i) {
    const double a = M_PI / 2 + i * M_PI / 180;
    stadium.points_m.emplace_back(-5e-3 + 1e-3 * std::cos(a), 1e-3 * std::sin(a));
  }
  const GuidePath guide = make_guide(stadium, 1.0, settings);
  for (const double torn_m : {0.6e-3, 0.9e-3, 1.1e-3, 1.6e-3, 3e-3}) {
    ConstraintGenerator generator;
    double fastest = 0.0;
    Vec3 x(6e-3, 0, 0);
    generator.at(guide, x.head<2>(), kDt);
    while (x.x() > 6e-3 - torn_m) {
      x.x() -= 50e-6;
      generator.at(guide, x.head<2>(), kDt);
    }
    Vec3 v = Vec3::Zero();
    for (int n = 0; n < 1000; ++n) {
      v += guided_acceleration(generator.at(guide, x.head<2>(), kDt), settings, {x, v}, Vec3::Zero()) * kDt;
      x += v * kDt;
      fastest = std::max(fastest, v.norm());
    }
    EXPECT_LT(guide.curve.find(x.head<2>()).distance_m, 0.1e-6) << torn_m;
    EXPECT_LT(fastest, 0.056) << torn_m;
  }
}

}  // namespace
}  // namespace telekerf::master
