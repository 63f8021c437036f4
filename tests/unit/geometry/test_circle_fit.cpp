// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "common/geometry/circle_fit.h"

namespace telekerf::geometry {
namespace {

std::vector<Vec2> arc(const Vec2& centre, double radius, double from, double to, int points) {
  std::vector<Vec2> out;
  for (int i = 0; i < points; ++i) {
    const double a = from + (to - from) * i / (points - 1);
    out.push_back(centre + radius * Vec2(std::cos(a), std::sin(a)));
  }
  return out;
}

TEST(CircleFit, ExactOnNoiselessArcs) {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int round = 0; round < 300; ++round) {
    const double radius = std::pow(10.0, -4.0 + 4.0 * u(rng));
    const Vec2 centre(0.1 * u(rng), -0.1 * u(rng));
    const double from = 6.0 * u(rng);
    const double sweep = (round % 2 == 0 ? 1.0 : -1.0) * (0.3 + 5.5 * u(rng));
    const auto points = arc(centre, radius, from, from + sweep, 3 + round % 20);
    const CircleOrLine c = fit_circle(points);
    ASSERT_FALSE(c.is_line) << round;
    EXPECT_NEAR(c.radius_m, radius, 1e-10 * radius + 1e-13) << round;
    EXPECT_LT((c.centre_m - centre).norm(), 1e-10 * radius + 1e-13) << round;
    EXPECT_EQ(c.anticlockwise, sweep > 0.0) << round;
    EXPECT_LT(c.residual_m, 1e-12);
    EXPECT_EQ(c.curvature() > 0.0, sweep > 0.0);
  }
}

TEST(CircleFit, StraightPointsBecomeALine) {
  for (const double angle : {0.0, 0.3, 1.2, 2.9, -2.0}) {
    const Vec2 d(std::cos(angle), std::sin(angle));
    std::vector<Vec2> points;
    points.reserve(11);
    for (int i = 0; i < 11; ++i) points.push_back(Vec2(0.02, -0.03) + 1e-4 * i * d);
    const CircleOrLine c = fit_circle(points);
    ASSERT_TRUE(c.is_line);
    EXPECT_LT((c.direction - d).norm(), 1e-12);
    EXPECT_NEAR(c.phi(points[3] + 1e-3 * Vec2(-d.y(), d.x())), 1e-3, 1e-15);
    EXPECT_EQ(c.curvature(), 0.0);
  }
}

TEST(CircleFit, HardlyBentIsACircleStillAndLessIsALine) {
  for (const double radius_m : {1e5, -1e5, 1e7}) {
    std::vector<Vec2> points;
    for (int i = -5; i <= 5; ++i) points.emplace_back(0.1 * i, 0.005 * i * i / radius_m);
    const CircleOrLine c = fit_circle(points);
    EXPECT_EQ(c.is_line, radius_m > 1e6) << radius_m;
    if (!c.is_line) {
      EXPECT_NEAR(1.0 / c.curvature(), radius_m, 1e-3 * std::abs(radius_m));
    }
  }
  for (const double curvature : {2e-3, -2e-3, 0.5e-3, -0.5e-3, 100.0}) {
    const CircleOrLine c = osculating({1, 2}, {0, 1}, curvature);
    EXPECT_EQ(c.is_line, std::abs(curvature) < 1e-3);
    EXPECT_NEAR(c.curvature(), c.is_line ? 0.0 : curvature, 1e-12);
    EXPECT_NEAR(c.phi({1, 2}), 0.0, 1e-9);
    EXPECT_LT((c.tangent({1, 2}) - Vec2(0, 1)).norm(), 1e-9);
  }
}

TEST(CircleFit, DegenerateWindowsNeverFail) {
  EXPECT_TRUE(fit_circle({}).is_line);
  const std::vector<Vec2> one{{1, 2}};
  EXPECT_NEAR(fit_circle(one).phi({1, 2}), 0.0, 1e-15);
  const std::vector<Vec2> same(7, Vec2(1, 2));
  EXPECT_TRUE(fit_circle(same).is_line);
  const std::vector<Vec2> two{{0, 0}, {1, 1}};
  EXPECT_NEAR(fit_circle(two).phi({0.5, 0.5}), 0.0, 1e-15);
  EXPECT_GT(fit_circle(two).phi({0, 1}), 0.0);
}

TEST(CircleFit, ShortNoisyArcsAreNotShrunk) {
  // 11 points of a 30 degree arc, r = 2, sigma = 0.01: plain least squares (eq. 19) finds 1.80 on average.
  std::mt19937_64 rng(2);
  std::normal_distribution<double> noise(0.0, 0.01);
  double curvature = 0.0;
  double radius = 0.0;
  constexpr int kRounds = 4000;
  for (int round = 0; round < kRounds; ++round) {
    auto points = arc({0, 0}, 2.0, 0.5, 0.5 + M_PI / 6, 11);
    for (Vec2& p : points) p += Vec2(noise(rng), noise(rng));
    const CircleOrLine c = fit_circle(points);
    curvature += c.curvature() / kRounds;
    radius += c.radius_m / kRounds;
  }
  RecordProperty("mean_radius", std::to_string(radius));
  EXPECT_NEAR(1.0 / curvature, 2.0, 0.03);
  EXPECT_NEAR(radius, 2.0, 0.12);  // the radius of a noisy arc has a long upper tail, its curvature has not
}

TEST(CircleFit, PhiAndItsDerivativesAgreeWithDifferences) {
  std::mt19937_64 rng(4);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (int round = 0; round < 200; ++round) {
    const double sweep = round % 3 == 0 ? 0.0 : (round % 2 == 0 ? 2.0 : -2.0);
    std::vector<Vec2> points = sweep == 0.0 ? std::vector<Vec2>{{0, 0}, {0.5, 0.2}, {1.0, 0.4}}
                                            : arc({0.2, 0.1}, 0.8, 1.0, 1.0 + sweep, 9);
    const CircleOrLine c = fit_circle(points);
    const Vec2 x(u(rng), u(rng));
    if (!c.is_line && (x - c.centre_m).norm() < 0.05) continue;
    const double h = 1e-6;
    for (int axis = 0; axis < 2; ++axis) {
      const Vec2 e = h * Vec2::Unit(axis);
      EXPECT_NEAR((c.phi(x + e) - c.phi(x - e)) / (2 * h), c.gradient(x)[axis], 1e-8);
      EXPECT_LT(((c.gradient(x + e) - c.gradient(x - e)) / (2 * h) - c.hessian(x).col(axis)).norm(), 1e-6);
    }
    EXPECT_NEAR(c.gradient(x).norm(), 1.0, 1e-12);
    EXPECT_NEAR(c.phi(c.project(x)), 0.0, 1e-12);
  }
}

TEST(CircleFit, SignsDoNotFlipFromArcToLineToArc) {
  // An S: left turn, straight, right turn. A point to the left of travel is positive all along.
  Polyline line{arc({0, 1}, 1.0, -M_PI / 2 - 1.0, -M_PI / 2, 101), false};
  for (int i = 1; i <= 100; ++i) line.points_m.emplace_back(0.01 * i, 0.0);
  for (const Vec2& p : arc({1, -1}, 1.0, M_PI / 2 - 0.01, M_PI / 2 - 1.0, 100)) line.points_m.push_back(p);
  bool lines = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const CircleOrLine c = fit_circle(window(line, i, 5).view());
    lines = lines || c.is_line;
    const Vec2 t =
        (line.points_m[std::min(i + 1, line.size() - 1)] - line.points_m[i > 0 ? i - 1 : 0]).normalized();
    EXPECT_NEAR(c.phi(line.points_m[i] + 0.1 * Vec2(-t.y(), t.x())), 0.1, 0.01) << i;
    EXPECT_GT(c.tangent(line.points_m[i]).dot(t), 0.99) << i;
  }
  EXPECT_TRUE(lines);
}

TEST(Window, ClampsAtEndsAndWrapsAround) {
  Polyline line{{}, false};
  for (int i = 0; i < 10; ++i) line.points_m.emplace_back(i, 0);
  const auto first = [&](std::size_t m, std::size_t k) { return window(line, m, k).points[0].x(); };
  EXPECT_EQ(first(5, 2), 3);
  EXPECT_EQ(first(0, 2), 0);
  EXPECT_EQ(first(9, 2), 5);
  EXPECT_EQ(window(line, 0, 2).count, 5u);
  EXPECT_EQ(window(line, 0, 100).count, 9u);
  line.closed = true;
  EXPECT_EQ(first(0, 2), 8);
  EXPECT_EQ(first(9, 2), 7);
  EXPECT_EQ(window(line, 9, 2).points[4].x(), 1);
  EXPECT_EQ(window(Polyline{}, 0, 3).count, 0u);
}

}  // namespace
}  // namespace telekerf::geometry
