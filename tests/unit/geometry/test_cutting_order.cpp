// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <vector>

#include "common/geometry/cutting_order.h"

namespace telekerf::geometry {
namespace {

Polyline box(const Vec2& corner, double side, bool closed = true) {
  return {{corner, corner + Vec2(side, 0), corner + Vec2(side, side), corner + Vec2(0, side)}, closed};
}

using Order = std::vector<std::size_t>;

TEST(CuttingOrder, EnclosureIsOfClosedLinesAndByTheFirstPoint) {
  const Polyline outer = box({0, 0}, 4);
  EXPECT_TRUE(encloses(outer, box({1, 1}, 1)));
  EXPECT_TRUE(encloses(outer, box({0.1, 3.8}, 0.1)));
  EXPECT_FALSE(encloses(box({1, 1}, 1), outer));
  for (const Vec2& beside : {Vec2(-1, 1), Vec2(5, 1), Vec2(1, -1), Vec2(1, 5)})
    EXPECT_FALSE(encloses(outer, box(beside, 0.5))) << beside.transpose();
  EXPECT_FALSE(encloses(box({0, 0}, 4, false), box({1, 1}, 1)));
  EXPECT_FALSE(encloses(outer, {}));
  EXPECT_FALSE(encloses({{{0, 0}, {4, 4}}, true}, box({1, 1}, 1)));
  // Slanted edges: left and right of a triangle's legs.
  const Polyline triangle{{{0, 0}, {4, 0}, {2, 4}}, true};
  EXPECT_TRUE(encloses(triangle, {{{1.1, 2}}, false}));
  EXPECT_FALSE(encloses(triangle, {{{0.9, 2}}, false}));
  EXPECT_TRUE(encloses(triangle, {{{2.9, 2}}, false}));
  EXPECT_FALSE(encloses(triangle, {{{3.1, 2}}, false}));
}

TEST(CuttingOrder, TheNearestThatWaitsForNothingComesNext) {
  const Polyline stroke{{{5, 0}, {9, 0}}, false};  // ends at x = 9
  const CuttingOrder cut =
      cutting_order({box({8.5, 0}, 0.25), box({4, 0}, 0.25), stroke, box({1, 0}, 0.25)}, {0, 0});
  EXPECT_EQ(cut.order, (Order{3, 1, 2, 0}));
  EXPECT_DOUBLE_EQ(cut.travel_m, 1.0 + 3.0 + 1.0 + 0.5);
  const CuttingOrder from_right = cutting_order({box({1, 0}, 0.25), box({3, 0}, 0.25)}, {4, 0});
  EXPECT_EQ(from_right.order, (Order{1, 0}));
  EXPECT_DOUBLE_EQ(from_right.travel_m, 1.0 + 2.0);
}

TEST(CuttingOrder, EverythingInsideComesBeforeWhatIsAroundIt) {
  const std::vector<Polyline> nest{box({0, 0}, 9), box({1, 1}, 7), box({2, 2}, 5), box({20, 0}, 1),
                                   box({6.5, 6.5}, 0.2)};
  const CuttingOrder cut = cutting_order(nest, {0, 0});
  EXPECT_EQ(cut.order, (Order{4, 2, 1, 0, 3}));
}

TEST(CuttingOrder, ContoursWithoutPointsAndOnesThatEncloseEachOtherHaveAPlaceToo) {
  EXPECT_EQ(cutting_order({}).order, Order{});
  const CuttingOrder cut = cutting_order({{}, box({3, 4}, 1)});
  EXPECT_EQ(cut.order, (Order{0, 1}));
  EXPECT_DOUBLE_EQ(cut.travel_m, 5.0);
  // Each begins inside of the other.
  const Polyline a{{{1, 1}, {-2, -2}, {-2, 4}, {4, 4}, {4, -2}, {1.5, -2}}, true};
  const Polyline b{{{0, 1}, {6, -3}, {6, 6}, {-6, 6}, {-6, -6}, {0, -6}}, true};
  ASSERT_TRUE(encloses(a, b) && encloses(b, a));
  EXPECT_EQ(cutting_order({a, b}).order.size(), 2u);
}

}  // namespace
}  // namespace telekerf::geometry
