// SPDX-License-Identifier: Apache-2.0
// From pixels to the workpiece: size, place and direction.
#include <gtest/gtest.h>

#include <cmath>

#include "common/vision/scaling.h"

namespace telekerf::vision {
namespace {

TEST(Scaling, CirclesStayRoundAndLettersReadable) {
  PixelContour ring;
  for (int i = 0; i < 360; ++i)
    ring.points_px.emplace_back(301.3 + 77.7 * std::cos(i * M_PI / 180),
                                99.1 + 77.7 * std::sin(i * M_PI / 180));
  for (const AnchorMode anchor :
       {AnchorMode::kBoundingBox, AnchorMode::kFirstPoint, AnchorMode::kImageCentre}) {
    const Scale scale = scale_for(ring, 640, 480, {.picture_width_m = 0.0317, .anchor = anchor});
    const auto line = to_workpiece(ring, scale);
    const auto box = geometry::bounding_box(line.points_m);
    EXPECT_NEAR(box.size().x() / box.size().y(), 1.0, 1e-12);
    EXPECT_NEAR(box.size().x(), 2 * 77.7 * 0.0317 / 640, 1e-15);
    EXPECT_LT(scale.to_workpiece(scale.anchor_px).norm(), 1e-18);
    EXPECT_LT((scale.to_picture(scale.to_workpiece({12, 34})) - Vec2(12, 34)).norm(), 1e-10);
  }
  const Scale scale = scale_for(ring, 640, 480, {.picture_width_m = 0.064});
  EXPECT_GT(scale.to_workpiece({400, 0}).y(), scale.to_workpiece({400, 100}).y());  // up stays up
  EXPECT_GT(scale.to_workpiece({400, 0}).x(), scale.to_workpiece({300, 0}).x());    // right stays right
  EXPECT_NEAR(scale.to_workpiece({639.5, 0}).x() - scale.to_workpiece({-0.5, 0}).x(), 0.064, 1e-15);
}

TEST(Scaling, PixelsThatAreNotSquareHaveTwoScales) {
  PixelContour ring;
  for (int i = 0; i < 360; ++i)
    ring.points_px.emplace_back(320 + 100 * std::cos(i * M_PI / 180), 240 + 50 * std::sin(i * M_PI / 180));
  const Scale scale = scale_for(ring, 640, 480, {.picture_width_m = 0.064, .picture_height_m = 0.096});
  const Vec2 size = geometry::bounding_box(to_workpiece(ring, scale).points_m).size();
  EXPECT_NEAR(size.x(), 0.02, 1e-15);
  EXPECT_NEAR(size.x() / size.y(), 1.0, 1e-12);
  EXPECT_LT((scale.to_picture(scale.to_workpiece({12, 34})) - Vec2(12, 34)).norm(), 1e-10);
}

TEST(Scaling, WithoutAWidthTheContourFillsSixtyPerCent) {
  PixelContour shape;
  shape.points_px = {{10, 10}, {210, 20}, {200, 110}, {20, 100}};
  const auto line = to_workpiece(shape, scale_for(shape, 640, 480, {.workspace_radius_m = 0.05}));
  EXPECT_NEAR(geometry::bounding_circle(line.points_m).radius_m, 0.03, 1e-12);
  EXPECT_LT(geometry::bounding_box(line.points_m).centre().norm(), 1e-12);
}

}  // namespace
}  // namespace telekerf::vision
