// SPDX-License-Identifier: Apache-2.0
// What a nearest point says of itself: place, side, direction, and how far a local search goes.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/geometry/nearest.h"

namespace telekerf::geometry {
namespace {

const Polyline kSquare{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, true};

TEST(Nearest, SaysWhereOnTheLineItIs) {
  const NearestIndex index(kSquare);
  EXPECT_EQ(index.length_m(), 16.0);
  struct Case {
    Vec2 query, point, tangent;
    std::size_t segment;
    double along, arc, distance;
  };
  for (const Case& c :
       {Case{{1, 0.5}, {1, 0}, {1, 0}, 0, 0.25, 1.0, 0.5},
        Case{{1, -0.5}, {1, 0}, {1, 0}, 0, 0.25, 1.0, -0.5},
        Case{{3.5, 3}, {4, 3}, {0, 1}, 1, 0.75, 7.0, 0.5}, Case{{6, 3}, {4, 3}, {0, 1}, 1, 0.75, 7.0, -2.0},
        Case{{1, 3.9}, {1, 4}, {-1, 0}, 2, 0.75, 11.0, 0.1},
        Case{{-0.25, 1}, {0, 1}, {0, -1}, 3, 0.75, 15.0, -0.25}}) {
    const Nearest found = index.find(c.query);
    EXPECT_LT((found.point_m - c.point).norm(), 1e-15) << c.query.transpose();
    EXPECT_EQ(found.segment, c.segment);
    EXPECT_NEAR(found.along, c.along, 1e-15);
    EXPECT_NEAR(found.arc_length_m, c.arc, 1e-14);
    EXPECT_NEAR(found.signed_distance_m, c.distance, 1e-14);
    EXPECT_NEAR(found.distance_m, std::abs(c.distance), 1e-14);
    EXPECT_EQ(found.tangent, c.tangent);
    const Nearest again = index.at(c.arc);
    EXPECT_LT((again.point_m - c.point).norm(), 1e-15);
    EXPECT_EQ(again.segment, c.segment);
    EXPECT_EQ(index.at(c.arc + 16.0).segment, c.segment) << "round again";
    EXPECT_NEAR(index.at(c.arc - 32.0).arc_length_m, c.arc, 1e-14);
  }
  EXPECT_EQ(index.at(4.0).segment, 1u) << "a vertex begins a segment";
  EXPECT_EQ(index.at(0.0).segment, 0u);
}

TEST(Nearest, TheNearerVertexIsNamed) {
  const NearestIndex closed(kSquare);
  EXPECT_EQ(closed.at(5.9).vertex(closed.line()), 1u);
  EXPECT_EQ(closed.at(6.1).vertex(closed.line()), 2u);
  EXPECT_EQ(closed.at(14.1).vertex(closed.line()), 0u) << "the last segment ends at the first";
  const NearestIndex open({kSquare.points_m, false});
  EXPECT_EQ(open.at(99.0).vertex(open.line()), 3u);
  EXPECT_EQ(open.at(-1.0).vertex(open.line()), 0u);
}

// An acute corner: on one side of it both of its segments name different sides.
TEST(Nearest, AtAVertexBothSegmentsDecideTheSide) {
  for (const bool closed : {false, true}) {
    for (const bool at_seam : {false, true}) {
      // A needle with its tip at the origin, run through from above to below: its inside lies to the right.
      Polyline needle{{{-4, 0.5}, {0, 0}, {-4, -0.5}}, closed};
      if (at_seam) needle.points_m = {{0, 0}, {-4, -0.5}, {-4, 0.5}};
      if (at_seam && !closed) continue;
      const NearestIndex index(needle);
      for (const double y : {-0.9, -0.2, 0.0, 0.2, 0.9}) {
        const Nearest tip = index.find({0.5, y});
        EXPECT_LT(tip.point_m.norm(), 1e-12);
        EXPECT_GT(tip.signed_distance_m, 0.0) << y << " beside the tip, outside";
      }
      EXPECT_LT(index.find({-1, 0}).signed_distance_m, 0.0) << "inside";
      EXPECT_GT(index.find({-1, 0.2}).signed_distance_m, 0.0);
    }
  }
}

TEST(Nearest, OnADoubledPointThereIsADirection) {
  const NearestIndex index(Polyline{{{0, 0}, {0, 0}, {0, 2}}, false});
  EXPECT_EQ(index.find({1, 1}).tangent, Vec2(0, 1));
  EXPECT_EQ(index.find({1, 1}).signed_distance_m, -1.0);
  EXPECT_EQ(NearestIndex(Polyline{{{3, 3}}, false}).find({4, 3}).tangent, Vec2(1, 0));
}

// Along a line that comes back beside itself: what a local search may reach, to the segment.
TEST(Nearest, ALocalSearchGoesSoFarAndNoFarther) {
  Polyline line{{}, false};
  for (int i = 0; i <= 40; ++i) line.points_m.emplace_back(i, 0.0);
  for (const bool closed : {false, true}) {
    line.closed = closed;
    const NearestIndex index(line);
    const auto reached = [&](std::size_t from, double x, const LocalReach& reach) {
      return index.find_near({x, 0.0}, from, reach).point_m.x();
    };
    for (const double way : {1.0, -1.0}) {
      // Walked 0, 1, .. 3 while no more than 3: four segments beyond the one it starts from.
      const double edge = way > 0.0 ? 21.0 : 20.0;
      EXPECT_EQ(reached(20, 20.5 + way * 3.0, {.arc_m = 3.0}), 20.5 + way * 3.0);
      EXPECT_EQ(reached(20, 20.5 + way * 10.0, {.arc_m = 3.0}), edge + way * 4.0);
      EXPECT_EQ(reached(20, 20.5 + way * 10.0, {.arc_m = 100.0, .segments = 2}), edge + way * 2.0);
    }
  }
  line.closed = false;
  const NearestIndex open(line);
  EXPECT_EQ(open.find_near({-5, 0}, 2, {.arc_m = 9.0}).point_m.x(), 0.0) << "not round an end";
  EXPECT_EQ(open.find_near({99, 0}, 37, {.arc_m = 9.0}).point_m.x(), 40.0);
  EXPECT_EQ(open.find_near({39.5, 0}, 1000, {}).segment, 39u) << "an index beyond the end is the end's";
  // Round the seam of a closed one, either way.
  const NearestIndex ring(kSquare);
  EXPECT_EQ(ring.find_near({0.5, 0}, 3, {.arc_m = 5.0}).segment, 0u);
  EXPECT_EQ(ring.find_near({0, 0.5}, 0, {.arc_m = 5.0}).segment, 3u);
}

TEST(Nearest, TheWholeLineIsSearchedWhateverItsLength) {
  std::mt19937_64 rng(11);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (std::size_t n = 2; n < 40; ++n) {
    Polyline line{{}, n % 2 == 0};
    for (std::size_t i = 0; i < n; ++i) line.points_m.emplace_back(u(rng), u(rng));
    const NearestIndex index(line);
    for (std::size_t i = 0; i < line.segments(); ++i) {
      const Vec2 middle = 0.5 * (line.start_of(i) + line.end_of(i));
      EXPECT_LT(index.find(middle).distance_m, 1e-15) << n << " " << i;
    }
  }
}

}  // namespace
}  // namespace telekerf::geometry
