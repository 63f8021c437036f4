// SPDX-License-Identifier: Apache-2.0
// Where the operator's robot may be led: what it cannot take is refused before anybody moves, and short of
// the ends of its rails stands a soft wall in every mode.
#pragma once

#include <span>

#include "common/robot/delta_kinematics.h"
#include "common/robot/robot_model.h"
#include "master/constraint/guide_path.h"

namespace telekerf::master {

/// The walls stand this far before the ends of the rails.
inline constexpr double kStrokeRoom_m = 2e-3;

/// Points of a contour (true size) for a master whose motion is scaled by `beta`: none of contour / beta may
/// leave the workspace. Quick, for what is far too large. Throws StartupError.
void require_room(const robot::RobotModel& model, std::span<const Vec2> points_m, double beta);

/// Every point of the guide, to either side as far as the corridor and above and below as far as the
/// constraint gives way, and the straight way to the guide from the workspace's centre. Throws StartupError
/// that names the first point that leaves the workspace, comes nearer than kStrokeRoom_m to the end of a
/// rail, or is worse conditioned than robot::kWorstCondition. Allocates nothing, but is no matter of one
/// control step.
void require_reach(const robot::RobotModel& model, const GuidePath& guide, double corridor_m);

/// Wanted joint accelerations, m/s^2, kept from running into the ends of the rails.
Vec3 within_strokes(const robot::DeltaGeometry& geometry, const Vec3& joints_m,
                    const Vec3& joint_velocity_m_per_s, const Vec3& wanted_m_per_s2) noexcept;

}  // namespace telekerf::master
