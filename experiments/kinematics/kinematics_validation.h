// SPDX-License-Identifier: Apache-2.0
// Kinematics and dynamics of a robot against MuJoCo (thesis 8.4): 5 mm steps, free fall, forced motion.
#pragma once

#include <vector>

#include "common/robot/robot_model.h"

namespace telekerf::experiments {

/// One sample of the run: what MuJoCo did ("measured") and what the kinematics make of it ("calculated").
struct KinematicsSample {
  double time_s = 0;
  Vec3 reference_m = Vec3::Zero();  ///< where the driving force wants the tool
  Vec3 tool_m = Vec3::Zero();       ///< measured
  Vec3 tool_calculated_m = Vec3::Zero();
  Vec3 joints_m = Vec3::Zero();  ///< measured
  Vec3 joints_calculated_m = Vec3::Zero();
  Vec3 velocity_m_per_s = Vec3::Zero();  ///< of the tool, measured
  Vec3 velocity_calculated_m_per_s = Vec3::Zero();
};

struct KinematicsValidation {
  std::vector<KinematicsSample> samples;
  double worst_forward_m = 0;    ///< MuJoCo's own constraint violation subtracted
  double worst_inverse_m = 0;    ///< likewise
  double worst_velocity = 0;     ///< as a share of the largest speed in the run
  double worst_violation_m = 0;  ///< of a rod's length, in MuJoCo
  double worst_tilt_rad = 0;     ///< of the tool, in MuJoCo
};

/// Drives the tool through steps of `step_m` in x, y and z and back, half a second each, by a force on the
/// tool alone; carriages run free, as in the thesis. Throws StartupError if the kinematics fail on the way.
KinematicsValidation validate_kinematics(const robot::RobotModel& robot, double step_m = 0.005);

struct DynamicsValidation {
  double worst_difference_m = 0;  ///< between the two tools
  double travelled_m = 0;         ///< largest distance from the start
  double share() const { return worst_difference_m / travelled_m; }
};

/// One second under gravity alone, weakened so that the carriages just stay on their rails.
DynamicsValidation validate_free_fall(const robot::RobotModel& robot);
/// One second under sinusoidal motor forces against joint springs, gravity held by constant forces.
DynamicsValidation validate_forced_motion(const robot::RobotModel& robot);

}  // namespace telekerf::experiments
