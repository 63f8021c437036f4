// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/geometry/nearest.h"
#include "slave/machining/path.h"

namespace telekerf::machining {
namespace {

using geometry::Polyline;

Polyline circle(double radius_m, int points) {
  Polyline line{{}, true};
  for (int i = 0; i < points; ++i) {
    const double t = 2.0 * std::numbers::pi * i / points;
    line.points_m.emplace_back(radius_m * std::cos(t), radius_m * std::sin(t));
  }
  return line;
}

Polyline square(double side_m) { return {{{0, 0}, {side_m, 0}, {side_m, side_m}, {0, side_m}}, true}; }

TEST(Path, CircleKeepsItsRadiusCurvatureAndLength) {
  const auto path = Path::through(circle(5e-3, 1600), {});
  ASSERT_TRUE(path) << path.error();
  EXPECT_NEAR(path->length_m(), 2.0 * std::numbers::pi * 5e-3, 20e-6);
  for (double s = 0.0; s < path->length_m(); s += 1e-3) {
    const PathPoint p = path->at(s);
    EXPECT_NEAR(p.position_m.norm(), 5e-3, 0.25e-6);  // what the smoothing takes off a bend
    EXPECT_NEAR(p.first.norm(), 1.0, 1e-9);
    EXPECT_NEAR(p.second.norm(), 200.0, 2.0);
    EXPECT_NEAR(p.first.dot(p.second), 0.0, 0.05);
  }
}

TEST(Path, DerivativesAreThoseOfThePosition) {
  for (const bool closed : {true, false}) {
    Polyline line = square(8e-3);
    line.closed = closed;
    const auto path = Path::through(line, {.tolerance_m = 20e-6});
    ASSERT_TRUE(path) << path.error();
    const double h = 0.2e-6;
    for (double s = 0.5e-3; s < path->length_m() - 0.5e-3; s += 0.137e-3) {
      const PathPoint a = path->at(s - h), b = path->at(s), c = path->at(s + h);
      EXPECT_LT(((c.position_m - a.position_m) / (2 * h) - b.first).norm(), 1e-4) << s;
      EXPECT_LT(((c.first - a.first) / (2 * h) - b.second).norm(), 1e-3 * (100.0 + b.second.norm())) << s;
    }
  }
}

TEST(Path, CornersStayWithinTheToleranceAndStraightsAreStraight) {
  const Polyline line = square(10e-3);
  for (const double tolerance_m : {10e-6, 20e-6}) {
    const auto path = Path::through(line, {.tolerance_m = tolerance_m});
    ASSERT_TRUE(path);
    const geometry::NearestIndex contour(line);
    double worst = 0.0;
    for (double s = 0.0; s < path->length_m(); s += 5e-6) {
      const Vec2 p = path->at(s).position_m.head<2>();
      const double off = contour.find(p).distance_m;
      worst = std::max(worst, off);
      const Vec2 to_corner = (p - 5e-3 * Vec2::Ones()).cwiseAbs() - 5e-3 * Vec2::Ones();
      if (to_corner.norm() > 0.4e-3 && to_corner.minCoeff() < -0.4e-3) {
        EXPECT_LT(off, 0.5e-6);
      }
    }
    EXPECT_LT(worst, tolerance_m);
    EXPECT_GT(worst, 0.4 * tolerance_m);
  }
}

TEST(Path, OpenEndsStayAndGoOnStraight) {
  const Polyline line{{{0, 0}, {2e-3, 0}, {4e-3, 1e-3}}, false};
  const auto path = Path::through(line, {});
  ASSERT_TRUE(path);
  EXPECT_LT(path->at(0).position_m.norm(), 1e-9);
  EXPECT_LT((path->at(path->length_m()).position_m.head<2>() - line.points_m.back()).norm(), 1e-9);
  EXPECT_LT((path->at(-1e-3).position_m - Vec3(-1e-3, 0, 0)).norm(), 2e-6);
}

TEST(Path, WrappedOnASphereStaysOnIt) {
  const double radius_m = 40e-3;
  const auto flat = Path::through(circle(8e-3, 2000), {});
  const auto path = wrapped(*flat, [&](const Vec2& p) {
    const double z = std::sqrt(radius_m * radius_m - p.squaredNorm());
    Surface s;
    s.height_m = z - radius_m;
    s.slope = -p / z;
    s.curvature = -Eigen::Matrix2d::Identity() / z - p * p.transpose() / (z * z * z);
    return s;
  });
  ASSERT_TRUE(path) << path.error();
  for (double s = 0.0; s < path->length_m(); s += 0.3e-3) {
    const PathPoint p = path->at(s);
    EXPECT_NEAR((p.position_m + Vec3(0, 0, radius_m)).norm(), radius_m, 1e-9);
    EXPECT_NEAR(p.second.norm(), 1.0 / 8e-3, 2.0);
  }
}

// A Gaussian moves a circle inwards by sigma^2 / 2R: as wide as the tolerance lets it, within its bounds.
TEST(Path, IsSmoothedAsMuchAsItsToleranceAllows) {
  const Polyline ring = circle(0.2e-3, 400);
  EXPECT_NEAR(smoothing_for(ring, {.tolerance_m = 1e-6}), 20e-6, 0.6e-6);
  EXPECT_NEAR(smoothing_for(ring, {.tolerance_m = 2e-6}), std::sqrt(2.0) * 20e-6, 0.6e-6);
  EXPECT_EQ(smoothing_for(ring, {.tolerance_m = 0.0}), 12e-6);
  EXPECT_EQ(smoothing_for(ring, {.tolerance_m = 10e-6}), 40e-6);
  EXPECT_EQ(smoothing_for({{{0, 0}, {3e-3, 1e-3}}, false}, {}), 40e-6) << "a straight line takes any";
  const auto path = Path::through(ring, {.tolerance_m = 1e-6});
  ASSERT_TRUE(path);
  EXPECT_NEAR(path->at(0.1e-3).position_m.norm(), 0.2e-3 - 1e-6, 0.1e-6);
  // Harmonics up to where the Gaussian's weight is exp(-3.7^2 / 2).
  EXPECT_EQ(path->harmonics(), static_cast<std::size_t>(std::ceil(3.7 * 0.4e-3 / 2.0 / path->smoothing_m())));
}

TEST(Path, ItsHarmonicsAreEightAtLeastAndFourThousandAtMost) {
  const auto harmonics = [](double radius_m, int points) {
    return Path::through(circle(radius_m, points), {.tolerance_m = 0.0})->harmonics();
  };
  // 3.7 L / (2 pi 12 um): 5 of a circle of 16 um, 4317 of one of 14 mm.
  EXPECT_EQ(harmonics(16e-6, 60), 8u);
  EXPECT_EQ(harmonics(30e-6, 60), 10u);
  EXPECT_EQ(harmonics(14e-3, 720), 4096u);
}

TEST(Path, ItsSmoothingIsASixtyFourthPartOfItsRange) {
  const auto ring = circle(0.2e-3, 400);
  int odd = 0;
  for (const double tolerance_m : {1e-6, 1.2e-6, 1.5e-6, 2e-6, 2.3e-6}) {
    const double steps = (smoothing_for(ring, {.tolerance_m = tolerance_m}) - 12e-6) / (28e-6 / 64);
    EXPECT_NEAR(steps, std::round(steps), 1e-6) << tolerance_m;
    odd += std::lround(steps) % 2 != 0 ? 1 : 0;
  }
  EXPECT_GT(odd, 0) << "and no coarser";
}

TEST(Path, TheThirdDerivativeIsThatOfTheSecond) {
  const auto path = Path::through(circle(1e-3, 800), {});
  ASSERT_TRUE(path);
  const double h = 0.5e-6;
  for (double s = 0.05e-3; s < 6e-3; s += 0.173e-3) {
    const Vec3 slope = (path->at(s + h).second - path->at(s - h).second) / (2 * h);
    EXPECT_LT((path->at(s).third - slope).norm(), 0.05 * 1e6) << s;
    EXPECT_NEAR(path->at(s).third.norm(), 1e6, 0.1e6) << s << " of a circle: 1 / R^2";
  }
}

// Pieces of a third of a radian: what the fifth power has of the third derivative is a twelfth of it.
TEST(Path, WithinAPieceEachDerivativeIsThatOfTheOneBefore) {
  std::vector<PathNode> nodes;
  for (int i = 0; i <= 6; ++i) {
    const double a = 0.4 * i;
    const Vec3 out(std::cos(a), std::sin(a), 0), along(-std::sin(a), std::cos(a), 0);
    nodes.push_back({a, 1e-3 * out, 1e-3 * along, -1e-3 * out});
  }
  const auto path = Path::through(nodes, false);
  ASSERT_TRUE(path);
  const double h = 0.1e-6;
  for (int piece = 0; piece < 6; ++piece) {
    for (const double u : {0.1, 0.3, 0.5, 0.8, 0.95}) {
      const double s = (piece + u) / 6.0 * path->length_m();
      const PathPoint a = path->at(s - h), b = path->at(s), c = path->at(s + h);
      EXPECT_LT(((c.position_m - a.position_m) / (2 * h) - b.first).norm(), 1e-3) << s;
      EXPECT_LT(((c.first - a.first) / (2 * h) - b.second).norm(), 1e-2 * 1e3) << s;
      EXPECT_LT(((c.second - a.second) / (2 * h) - b.third).norm(), 1e-3 * 1e6) << s;
    }
  }
}

TEST(Path, GoesRoundAgainOrOnStraight) {
  const auto ring = Path::through(circle(5e-3, 800), {});
  ASSERT_TRUE(ring);
  for (const double s : {0.0, 1e-3, 20e-3}) {
    EXPECT_LT((ring->at(s + ring->length_m()).position_m - ring->at(s).position_m).norm(), 1e-12);
    EXPECT_LT((ring->at(s - ring->length_m()).position_m - ring->at(s).position_m).norm(), 1e-12);
  }
  const auto line = Path::through(Polyline{{{0, 0}, {3e-3, 4e-3}}, false}, {});
  ASSERT_TRUE(line);
  EXPECT_NEAR(line->length_m(), 5e-3, 1e-9);
  const PathPoint beyond = line->at(6e-3);
  EXPECT_LT((beyond.position_m - Vec3(3.6e-3, 4.8e-3, 0)).norm(), 1e-9);
  EXPECT_LT((beyond.first - Vec3(0.6, 0.8, 0)).norm(), 1e-9);
  EXPECT_EQ(beyond.second.norm(), 0.0);
}

TEST(Path, ThroughNodesItsParameterIsTheArcAndBadOnesAreRefused) {
  // A quarter of a circle by an odd parameter: t^2.
  std::vector<PathNode> nodes;
  for (int i = 1; i <= 40; ++i) {
    const double t = i / 40.0, a = t * t;
    nodes.push_back(
        {t, 2e-3 * Vec3(std::cos(a), std::sin(a), 0), 2e-3 * 2 * t * Vec3(-std::sin(a), std::cos(a), 0),
         2e-3 * (2.0 * Vec3(-std::sin(a), std::cos(a), 0) - 4 * t * t * Vec3(std::cos(a), std::sin(a), 0))});
  }
  const auto path = Path::through(nodes, false);
  ASSERT_TRUE(path);
  const double from = 1.0 / 1600.0;
  EXPECT_NEAR(path->length_m(), 2e-3 * (1.0 - from), 1e-12);
  for (double s = 0.0; s < path->length_m(); s += 0.1e-3) {
    const double a = s / 2e-3 + from;
    EXPECT_LT((path->at(s).position_m - 2e-3 * Vec3(std::cos(a), std::sin(a), 0)).norm(), 1e-11) << s;
    EXPECT_NEAR(path->at(s).second.norm(), 500.0, 0.5);
  }
  EXPECT_FALSE(Path::through(std::vector<PathNode>{nodes[0]}, false));
  for (const double bad : {0.0, double{INFINITY}, double{NAN}}) {
    auto without = nodes;
    without[3].first = Vec3::Constant(bad);
    const auto refused = Path::through(without, false);
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(refused.error(), "the path has a point without a direction");
  }
  auto twice = nodes;
  twice[3].parameter = twice[2].parameter;
  EXPECT_FALSE(Path::through(twice, false)) << "not even as large";
  std::swap(nodes[3], nodes[4]);
  EXPECT_FALSE(Path::through(nodes, false));
  EXPECT_FALSE(Path::through(Polyline{{{0, 0}, {1e-3, 0}}, true}, PathSettings{}))
      << "two points close nothing";
  EXPECT_TRUE(Path::through(Polyline{{{0, 0}, {1e-3, 0}}, false}, PathSettings{}));
}

TEST(Path, RefusesWhatHasNoDirection) {
  EXPECT_FALSE(Path::through(Polyline{{{0, 0}, {0, 0}}, false}, PathSettings{}));
  EXPECT_FALSE(Path::through(Polyline{{{0, 0}, {NAN, 1}, {1, 0}}, true}, PathSettings{}));
}

}  // namespace
}  // namespace telekerf::machining
