// SPDX-License-Identifier: Apache-2.0
#include "common/robot/kinematics_error.h"

#include <fmt/format.h>

namespace telekerf::robot {

std::string describe(const KinematicsError& error) {
  const std::string leg = error.leg < 0 ? "the robot" : fmt::format("leg {}", error.leg + 1);
  switch (error.kind) {
    case KinematicsError::Kind::kNotFinite:
      return "the pose holds a number that is not finite";
    case KinematicsError::Kind::kUnreachable:
      return fmt::format("{} cannot reach the pose: its rod is {:.6g} m too short", leg, error.value_m);
    case KinematicsError::Kind::kOutOfStroke:
      return fmt::format("{} is out of stroke: {:.6g} m is beyond its end at {:.6g} m", leg, error.value_m,
                         error.bound_m);
    case KinematicsError::Kind::kOtherAssembly:
      return "the pose is on the other side of the carriages than the robot is assembled; "
             "does working_mode fit assembly_mode?";
    case KinematicsError::Kind::kSerialSingular:
      return fmt::format("{} is singular: its rod stands square to its rail and cannot move the tool", leg);
    case KinematicsError::Kind::kParallelSingular:
      return "the robot is singular: its three rods or carriages leave one direction of the tool free";
  }
  return "unknown";
}

}  // namespace telekerf::robot
