// SPDX-License-Identifier: Apache-2.0
// The space that a robot can work in: its largest upright cylinder, with a bound on the conditioning.
#pragma once

#include "common/robot/delta_kinematics.h"

namespace telekerf::robot {

/// Upright cylinder in base; every point in it can be reached.
struct Workspace {
  Vec3 centre_m = Vec3::Zero();
  double radius_m = 0.0;
  double height_m = 0.0;
};

/// Poses with a worse condition number than this are no place to work.
inline constexpr double kWorstCondition = 8.0;

/// True if the pose can be reached and its condition number is at most `worst_condition`.
bool workable(const DeltaKinematics& kinematics, const Vec3& tool_m,
              double worst_condition = kWorstCondition) noexcept;

/// The upright cylinder of the largest volume whose points are all workable, found on a grid of `cells`
/// points an axis and then checked on its surface. Radius 0: there is none. The axis x = y = 0 is kept unless
/// another one is clearly better.
Workspace largest_cylinder(const DeltaKinematics& kinematics, double worst_condition = kWorstCondition,
                           int cells = 41);

/// Worst condition number over the cylinder (sampled); infinite if a sample cannot be reached.
double worst_condition(const DeltaKinematics& kinematics, const Workspace& workspace);

}  // namespace telekerf::robot
