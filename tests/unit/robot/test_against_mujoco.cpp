// SPDX-License-Identifier: Apache-2.0
// Kinematics and dynamics against an independent rigid-body engine, for every shipped robot.
#include <gtest/gtest.h>

#include "common/runtime/resources.h"
#include "experiments/kinematics/kinematics_validation.h"

namespace telekerf::experiments {
namespace {

class AgainstMujoco : public ::testing::TestWithParam<const char*> {};

TEST_P(AgainstMujoco, FiveMillimetreStepsAgree) {
  const KinematicsValidation steps = validate_kinematics(robot::load_robot(GetParam()));
  EXPECT_LE(steps.worst_forward_m, 1e-6);
  EXPECT_LE(steps.worst_inverse_m, 1e-6);
  EXPECT_LE(steps.worst_velocity, 1e-3);
  // The parallelograms do keep the tool from turning, and the engine's rods keep their length.
  EXPECT_LE(steps.worst_tilt_rad, 1e-5);
  EXPECT_LE(steps.worst_violation_m, 1e-6);
  std::printf("%-18s FK %.1e m, IK %.1e m, velocity %.1e, engine's rod error %.1e m\n", GetParam(),
              steps.worst_forward_m, steps.worst_inverse_m, steps.worst_velocity, steps.worst_violation_m);
}

TEST_P(AgainstMujoco, FreeFallAgrees) {
  const DynamicsValidation fall = validate_free_fall(robot::load_robot(GetParam()));
  EXPECT_GT(fall.travelled_m, 1e-3);
  EXPECT_LE(fall.share(), 0.01);
  std::printf("%-18s free fall: %.2e m of %.2e m\n", GetParam(), fall.worst_difference_m, fall.travelled_m);
}

TEST_P(AgainstMujoco, ForcedMotionAgrees) {
  const DynamicsValidation forced = validate_forced_motion(robot::load_robot(GetParam()));
  EXPECT_GT(forced.travelled_m, 1e-3);
  EXPECT_LE(forced.share(), 0.01);
  std::printf("%-18s forced: %.2e m of %.2e m\n", GetParam(), forced.worst_difference_m, forced.travelled_m);
}

INSTANTIATE_TEST_SUITE_P(Shipped, AgainstMujoco,
                         ::testing::Values("master-horizontal", "slave-keops", "vertical", "asymmetric"));

}  // namespace
}  // namespace telekerf::experiments
