// SPDX-License-Identifier: Apache-2.0
// The bandwidths of a path follower, chosen from robot, sensor, rate and speed.
//
// A sensor's noise shakes the tool by the same m/s at any speed, so that a slow path would be burnt unevenly
// by a loop that is good for a fast one; but a slow loop knows too late that friction has turned round, at a
// corner most of all. So the observer is as fast as the noise allows: a hundredth of the speed.
#pragma once

#include "common/robot/robot_model.h"
#include "slave/machining/follower_settings.h"

namespace telekerf::machining {

/// Share of the speed by which the sensor's noise may shake the tool along the path, rms.
inline constexpr double kRipple = 0.010;
/// The same where the beam follows the speed and corners are slowed down for: friction counts for more than
/// ripple.
inline constexpr double kRippleAtCorners = 0.023;

/// `settings` (rate and delay are kept) for a path at `speed_m_per_s`. `model.sensor` reads the joints.
PathFollowerSettings tuned_for_speed(PathFollowerSettings settings, const robot::RobotModel& model,
                                     double speed_m_per_s, double ripple = kRipple);

}  // namespace telekerf::machining
