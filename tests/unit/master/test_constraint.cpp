// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "master/constraint.h"

namespace telekerf::master {
namespace {

ContourMessage circle(double radius_m) {
  ContourMessage contour;
  contour.id = 3;
  for (int i = 0; i < 720; ++i) {
    contour.points_m.emplace_back(radius_m * std::cos(i * M_PI / 360), radius_m * std::sin(i * M_PI / 360));
  }
  return contour;
}

ContourMessage figure_eight() {
  ContourMessage contour;
  for (int i = 0; i < 2000; ++i) {
    const double t = i * 2 * M_PI / 2000;
    contour.points_m.emplace_back(0.01 * std::sin(t), 0.005 * std::sin(2 * t));
  }
  return contour;
}

TEST(Guide, IsTheContourOverBeta) {
  const Guide guide = make_guide(circle(0.01), 0.5, {});
  EXPECT_EQ(guide.contour_id, 3u);
  for (const auto& point : guide.curve.line().points_m) EXPECT_NEAR(point.norm(), 0.02, 2e-6);
}

// A point mass that obeys the acceleration exactly, integrated finely, must show eq. 65's decay.
TEST(Constraint, ErrorDecaysAsEq65SaysWhileTheToolRunsRoundTheCircle) {
  ConstraintSettings settings;
  const Guide guide = make_guide(circle(0.01), 1.0, settings);
  ConstraintGenerator generator(settings);
  const double w = settings.bandwidth_rad_s;
  const double start = 0.3e-3;
  Vec3 x(0.01 + start, 0, start);
  Vec3 v(0, 0.03, 0);
  constexpr double kDt = 1e-5;
  for (int n = 0; n < 5000; ++n) {
    const auto active = generator.at(guide, x.head<2>());
    const Vec3 a = constrained_acceleration(active, settings, x, v, Vec3::Zero());
    v += a * kDt;
    x += v * kDt;
    const double t = (n + 1) * kDt;
    const double expected = start * (1.0 + w * t) * std::exp(-w * t);
    EXPECT_NEAR(x.head<2>().norm() - 0.01, expected, 0.02 * start) << t;
    EXPECT_NEAR(x.z(), expected, 0.02 * start) << t;
  }
}

TEST(Constraint, TheHandMovesTheVirtualMassAlongAndNothingAcross) {
  ConstraintSettings settings;
  const Guide guide = make_guide(circle(0.01), 1.0, settings);
  ConstraintGenerator generator(settings);
  const auto active = generator.at(guide, {0.01, 0});
  const Vec3 along = constrained_acceleration(active, settings, {0.01, 0, 0}, Vec3::Zero(), {0, 1.0, 0});
  EXPECT_NEAR(along.y(), (1.0 - settings.dead_force_n) / settings.mass_kg, 1e-2);
  const Vec3 across = constrained_acceleration(active, settings, {0.01, 0, 0}, Vec3::Zero(), {3.0, 0, 2.0});
  EXPECT_LT(across.norm(), 0.05);
}

TEST(Constraint, AtACrossingTheToolStaysOnItsBranch) {
  ConstraintSettings settings;
  const Guide guide = make_guide(figure_eight(), 1.0, settings);
  ConstraintGenerator generator(settings);
  double before = -1.0;
  const double length = guide.curve.length_m();
  // From the tip of one lobe, so that the first search has no choice, through the crossing twice.
  for (int i = 0; i <= 4000; ++i) {
    const double arc = length * (0.25 + 0.74 * i / 4000.0);
    // The hand strays 0.2 mm to the left of the curve all along.
    const auto at = guide.curve.at(arc);
    const Vec2 tool = at.point_m + 0.2e-3 * Vec2(-at.tangent.y(), at.tangent.x());
    const auto active = generator.at(guide, tool);
    if (before >= 0.0) {
      EXPECT_LT(std::abs(active.nearest.arc_length_m - before), 0.5e-3) << "at arc " << arc;
    }
    before = active.nearest.arc_length_m;
  }
}

TEST(Constraint, AnOpenCurveEndsInASoftStopThatLetsTheToolBack) {
  ContourMessage line;
  line.closed = false;
  for (int i = 0; i <= 100; ++i) line.points_m.emplace_back(i * 1e-4, 0.0);
  ConstraintSettings settings;
  const Guide guide = make_guide(line, 1.0, settings);
  ConstraintGenerator generator(settings);
  const auto beyond = generator.at(guide, {0.0102, 0.0});
  EXPECT_NEAR(beyond.beyond_end_m, 0.2e-3, 1e-6);
  const Vec3 pushed = constrained_acceleration(beyond, settings, {0.0102, 0, 0}, Vec3::Zero(), {3.0, 0, 0});
  EXPECT_LT(pushed.x(), 0.0);
  generator.reset();
  const auto inside = generator.at(guide, {0.0098, 0.0});
  EXPECT_EQ(inside.beyond_end_m, 0.0);
  const Vec3 back = constrained_acceleration(inside, settings, {0.0098, 0, 0}, Vec3::Zero(), {-3.0, 0, 0});
  EXPECT_LT(back.x(), -1.0);
}

}  // namespace
}  // namespace telekerf::master
