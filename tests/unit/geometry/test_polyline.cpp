// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/geometry/cutting_order.h"
#include "common/geometry/nearest.h"
#include "common/geometry/polyline.h"

namespace telekerf::geometry {
namespace {

Polyline circle(double radius, int points, const Vec2& centre = Vec2::Zero()) {
  Polyline out{{}, true};
  for (int i = 0; i < points; ++i) {
    const double a = 2.0 * M_PI * i / points;
    out.points_m.push_back(centre + radius * Vec2(std::cos(a), std::sin(a)));
  }
  return out;
}

Polyline figure_eight(int points) {
  Polyline out{{}, true};
  for (int i = 0; i < points; ++i) {
    const double a = 2.0 * M_PI * i / points + 0.3;
    out.points_m.emplace_back(0.02 * std::sin(a), 0.02 * std::sin(a) * std::cos(a));
  }
  return out;
}

Polyline random_walk(std::mt19937_64& rng, int points, bool closed) {
  std::normal_distribution<double> step(0.0, 1e-3);
  Polyline out{{}, closed};
  Vec2 at = Vec2::Zero();
  for (int i = 0; i < points; ++i) {
    out.points_m.push_back(at);
    if (i % 7 != 3) at += Vec2(step(rng), step(rng));  // some points twice
  }
  return out;
}

TEST(Polyline, LengthAreaAndBoxOfASquare) {
  const Polyline square{{{0, 0}, {2, 0}, {2, 2}, {0, 2}}, true};
  EXPECT_DOUBLE_EQ(length_m(square), 8.0);
  EXPECT_DOUBLE_EQ(length_m({square.points_m, false}), 6.0);
  EXPECT_DOUBLE_EQ(signed_area_m2(square), 4.0);
  EXPECT_DOUBLE_EQ(signed_area_m2(reversed(square)), -4.0);
  EXPECT_EQ(bounding_box(square.points_m).centre(), Vec2(1, 1));
}

TEST(Polyline, ResamplingIsEvenAndKeepsTheEnds) {
  std::mt19937_64 rng(3);
  for (const bool closed : {false, true}) {
    const Polyline line = random_walk(rng, 200, closed);
    const Polyline even = resampled(line, 0.3e-3);
    EXPECT_EQ(even.points_m.front(), line.points_m.front());
    if (!closed) {
      EXPECT_EQ(even.points_m.back(), line.points_m.back());
    }
    // No chord is longer than the arc it stands for, and every point lies on the line.
    const double arc = length_m(line) / static_cast<double>(even.segments());
    EXPECT_LE(arc, 0.3e-3 * (1 + 1e-12));
    const NearestIndex index(line);
    for (std::size_t i = 0; i < even.segments(); ++i) {
      EXPECT_LE((even.end_of(i) - even.start_of(i)).norm(), arc * (1 + 1e-9));
      EXPECT_LT(index.find(even.points_m[i]).distance_m, 1e-15);
    }
  }
  EXPECT_EQ(resampled({{{0, 0}, {1, 0}}, false}, 0.1).size(), 11u);
}

TEST(Polyline, BoundingCircleHoldsEverythingAndIsSmall) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (std::size_t size = 3; size < 53; ++size) {
    std::vector<Vec2> points;
    points.reserve(size);
    while (points.size() < size) points.emplace_back(u(rng), u(rng));
    const Circle c = bounding_circle(points);
    int touching = 0;
    for (const Vec2& p : points) {
      EXPECT_LE((p - c.centre_m).norm(), c.radius_m * (1 + 1e-9));
      touching += (p - c.centre_m).norm() > c.radius_m * (1 - 1e-9);
    }
    EXPECT_GE(touching, 2);  // a circle that nothing pins could be smaller
  }
  EXPECT_NEAR(bounding_circle(circle(3.0, 100, {1, 2}).points_m).radius_m, 3.0, 1e-9);
}

TEST(Polyline, DuplicatesGoAndSimplificationStaysNear) {
  const Polyline line{{{0, 0}, {0, 0}, {1, 0}, {1, 0}, {2, 0}, {2, 1}, {0, 0}}, true};
  EXPECT_EQ(without_duplicates(line).size(), 4u);
  const Polyline fine = circle(10.0, 2000);
  const Polyline coarse = simplified(fine, 0.01);
  EXPECT_LE(coarse.size(), 128u);
  const NearestIndex index(coarse);
  for (const Vec2& p : fine.points_m) EXPECT_LE(index.find(p).distance_m, 0.01 + 1e-12);
}

TEST(Nearest, AgreesWithTryingEverySegment) {
  std::mt19937_64 rng(7);
  std::normal_distribution<double> q(0.0, 15e-3);
  for (int round = 0; round < 60; ++round) {
    const Polyline line = random_walk(rng, 1 + round * 5, round % 2 == 0);
    const NearestIndex index(line);
    for (int i = 0; i < 40; ++i) {
      const Vec2 query(q(rng), q(rng));
      double best = 1e9;
      const Polyline& l = index.line();
      for (std::size_t s = 0; s < l.segments(); ++s) {
        const Vec2 d = l.end_of(s) - l.start_of(s);
        const double u =
            d.norm() > 0 ? std::clamp((query - l.start_of(s)).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
        best = std::min(best, (query - l.start_of(s) - u * d).norm());
      }
      const Nearest found = index.find(query);
      EXPECT_NEAR(found.distance_m, best, 1e-15) << "round " << round;
      EXPECT_DOUBLE_EQ(std::abs(found.signed_distance_m), found.distance_m);
      EXPECT_NEAR((index.at(found.arc_length_m).point_m - found.point_m).norm(), 0.0, 1e-12);
    }
  }
}

TEST(Nearest, LeftIsPositive) {
  const NearestIndex ring(circle(1.0, 64));
  std::mt19937_64 rng(9);
  std::uniform_real_distribution<double> u(-1.6, 1.6);
  for (int i = 0; i < 2000; ++i) {
    const Vec2 q(u(rng), u(rng));
    const double r = q.norm();
    if (std::abs(r - 1.0) < 0.01) continue;
    EXPECT_EQ(ring.find(q).signed_distance_m > 0.0, r < 1.0)
        << q.transpose();  // inside lies left of anticlockwise
  }
}

TEST(Nearest, EndsAndDegenerateLinesHaveAnAnswer) {
  const NearestIndex open(Polyline{{{0, 0}, {1, 0}}, false});
  EXPECT_NEAR(open.find({2, 0}).distance_m, 1.0, 1e-15);
  EXPECT_NEAR(open.find({-1, 0}).distance_m, 1.0, 1e-15);
  for (const bool closed : {false, true}) {
    EXPECT_NEAR(NearestIndex(Polyline{{}, closed}).find({3, 4}).distance_m, 5.0, 1e-15);
    EXPECT_NEAR(NearestIndex(Polyline{{{1, 1}}, closed}).find({1, 2}).distance_m, 1.0, 1e-15);
  }
  EXPECT_TRUE(std::isnan(open.find({NAN, 0}).distance_m));
}

TEST(Nearest, LocalSearchStaysOnItsBranchThroughACrossing) {
  const NearestIndex index(figure_eight(4000));
  Nearest here = index.at(0.0);
  const int steps = 5000;
  for (int i = 0; i <= steps; ++i) {
    const double s = index.length_m() * i / steps;
    const Nearest truth = index.at(s);
    // A hand beside the path: at the crossing the other branch is nearer for a while.
    const Vec2 hand = truth.point_m + 0.4e-3 * Vec2(-truth.tangent.y(), truth.tangent.x());
    here = index.find_near(hand, here.segment, {.arc_m = 2e-3});
    const double gap = std::abs(here.arc_length_m - truth.arc_length_m);
    EXPECT_LT(std::min(gap, index.length_m() - gap), 0.3e-3) << "s = " << s;
  }
  // The search over everything does jump: that is why the local one exists.
  int jumps = 0;
  for (int i = 0; i <= steps; ++i) {
    const double s = index.length_m() * i / steps;
    const Nearest truth = index.at(s);
    const Vec2 hand = truth.point_m + 0.4e-3 * Vec2(-truth.tangent.y(), truth.tangent.x());
    const double gap = std::abs(index.find(hand).arc_length_m - truth.arc_length_m);
    jumps += std::min(gap, index.length_m() - gap) > 1e-3;
  }
  EXPECT_GT(jumps, 0);
}

TEST(CuttingOrder, HolesComeFirstAndTheWayIsShort) {
  std::vector<Polyline> plate{circle(1.0, 60)};
  for (int i = 0; i < 6; ++i) {
    plate.push_back(circle(0.1, 30, 0.6 * Vec2(std::cos(i * 2.4), std::sin(i * 2.4))));
  }
  plate.push_back(circle(0.04, 30, plate[3].points_m[0] - Vec2(0.1, 0)));  // within a hole
  const CuttingOrder cut = cutting_order(plate);
  ASSERT_EQ(cut.order.size(), plate.size());
  EXPECT_EQ(cut.order.back(), 0u);
  const auto place = [&](std::size_t i) {
    return std::find(cut.order.begin(), cut.order.end(), i) - cut.order.begin();
  };
  EXPECT_LT(place(7), place(3));
  double naive = 0.0;
  Vec2 at = Vec2::Zero();
  for (std::size_t i = plate.size(); i-- > 0;) {
    naive += (plate[i].points_m[0] - at).norm();
    at = plate[i].points_m[0];
  }
  EXPECT_LT(cut.travel_m, naive);
}

}  // namespace
}  // namespace telekerf::geometry
