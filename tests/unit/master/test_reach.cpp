// SPDX-License-Identifier: Apache-2.0
// What the operator's robot cannot take is refused before anybody moves, and no hand gets it to the end of a
// rail.
#include <gtest/gtest.h>

#include <cmath>

#include "common/runtime/startup_error.h"
#include "master/constraint/reach.h"
#include "master/station.h"
#include "tests/unit/master/contours.h"

namespace telekerf::master {
namespace {

using testing::circle;

std::string refusal_of(const robot::RobotModel& model, double radius_m, double corridor_m) {
  ConstraintSettings coarse;
  coarse.spacing_m = 0.2e-3;
  coarse.half_window = 2;
  try {
    require_reach(model, make_guide(circle(radius_m), 1.0, coarse), corridor_m);
  } catch (const StartupError& refusal) {
    return refusal.what();
  }
  return {};
}

/// The shipped robot with a workspace that its file says is larger than it is good for.
robot::RobotModel boastful() {
  robot::RobotModel model = robot::load_robot("master-horizontal");
  model.workspace.radius_m = 1.0;
  return model;
}

TEST(Reach, ShippedWorkspaceIsAcceptedAndOutsideItRefused) {
  const auto model = robot::load_robot("master-horizontal");
  EXPECT_EQ(refusal_of(model, 0.02, 0.0), "");
  EXPECT_NE(refusal_of(model, model.workspace.radius_m + 1e-3, 0.0).find("use a larger --beta"),
            std::string::npos);
}

TEST(Reach, RoomIsAskedOfTheContourOverBeta) {
  const auto model = robot::load_robot("master-horizontal");
  const double radius_m = 0.9 * model.workspace.radius_m;
  EXPECT_NO_THROW(require_room(model, circle(radius_m).points_m, 1.0));
  EXPECT_NO_THROW(require_room(model, circle(2.0 * radius_m).points_m, 2.0));
  EXPECT_THROW(require_room(model, circle(radius_m).points_m, 0.5), StartupError);
}

TEST(Reach, RefusesWhatComesNearTheEndOfARailAndNamesPointValueBoundAndRemedy) {
  // Grows until it is refused: then a carriage is at the bound, not before.
  const auto model = boastful();
  const robot::DeltaKinematics kinematics(model.geometry);
  double radius = 0.01;
  while (refusal_of(model, radius, 0.0).empty() && radius < 0.3) radius += 0.2e-3;
  const std::string said = refusal_of(model, radius, 0.0);
  EXPECT_NE(said.find("contour point"), std::string::npos) << said;
  EXPECT_NE(said.find("mm"), std::string::npos) << said;
  EXPECT_NE(said.find("--beta"), std::string::npos) << said;
  EXPECT_NE(said.find("--anchor"), std::string::npos) << said;
  const double inside = radius - 0.4e-3;
  for (int i = 0; i < 360; ++i) {
    const Vec3 tool =
        model.in_base({inside * std::cos(i * M_PI / 180), inside * std::sin(i * M_PI / 180), 0.0});
    const auto joints = kinematics.inverse(tool);
    ASSERT_TRUE(joints);
    EXPECT_LE(joints->maxCoeff(), model.geometry.stroke_max_m - kStrokeRoom_m + 1e-4);
    EXPECT_GE(joints->minCoeff(), model.geometry.stroke_min_m + kStrokeRoom_m - 1e-4);
    EXPECT_LE(kinematics.conditioning(*joints, tool).condition, 1.01 * robot::kWorstCondition);
  }
  EXPECT_NE(refusal_of(model, inside, 2e-3), "") << "a corridor needs room to either side";
}

TEST(Reach, RefusesAnIllConditionedPose) {
  robot::RobotModel model = boastful();
  // Rails without ends: what is left is how the rods stand.
  model.geometry.stroke_min_m = -1.0;
  model.geometry.stroke_max_m = 1.0;
  double radius = 0.01;
  while (refusal_of(model, radius, 0.0).empty() && radius < 0.3) radius += 0.5e-3;
  EXPECT_NE(refusal_of(model, radius, 0.0).find("condition number"), std::string::npos)
      << refusal_of(model, radius, 0.0);
}

TEST(Reach, AJointComesToRestBeforeTheEndOfItsRail) {
  const auto geometry = robot::load_robot("master-horizontal").geometry;
  for (const double side : {-1.0, 1.0}) {
    const double end = side > 0.0 ? geometry.stroke_max_m : -geometry.stroke_min_m;
    Vec3 q(side * (end - 10e-3), 0, 0);
    Vec3 v(side * 0.2, 0, 0);
    double farthest = 0.0;
    for (int n = 0; n < 2000; ++n) {
      // Something wants it to go on and on.
      v += within_strokes(geometry, q, v, Vec3(side * 5.0, 0, 0)) * 1e-3;
      q += v * 1e-3;
      farthest = std::max(farthest, side * q[0]);
    }
    EXPECT_GT(farthest, end - kStrokeRoom_m) << "free until the wall";
    EXPECT_LT(farthest, end - 0.2e-3);
    const Vec3 back = within_strokes(geometry, q, {}, Vec3(-side * 5.0, 0, 0));
    EXPECT_LE(side * back[0], -5.0) << "nothing holds it there";
  }
}

}  // namespace
}  // namespace telekerf::master
