// SPDX-License-Identifier: Apache-2.0
// How fast a robot's control loop may be: the largest bandwidths whose margins hold. Nothing in it depends on
// the robot's mass, because disturbance observer and law work on accelerations; what bounds them is the rate,
// the delay of the drive, the sensor's noise against the motors' force, and how far the robot may be off its
// file.
#pragma once

#include "common/control/joint_acceleration_control.h"
#include "common/control/loop_margins.h"
#include "common/robot/robot_model.h"

namespace telekerf::control {

/// A loop is good if max |S| <= kMaxSensitivity on the robot of the file, <= kMaxSensitivityWorst on one
/// whose inertia is 30 % smaller and whose force constant is 30 % larger, and its noise is within bounds.
inline constexpr double kMaxSensitivity = 2.35;
inline constexpr double kMaxSensitivityWorst = 16.0;
inline constexpr double kWorstInertiaRatio = 0.7 / 1.3;
/// The observer's bandwidth over the law's, and the velocity estimate's over the observer's.
inline constexpr double kObserverOverLaw = 2.5;
inline constexpr double kVelocityOverObserver = 5.0;

/// The fastest good loop. What is given (not 0) is kept as it is, and the rest fitted to it.
LoopBandwidths design_loop(const LoopConditions& conditions, double law_rad_per_s = 0.0,
                           double observer_rad_per_s = 0.0);

/// For a robot that is to move evenly along a path: the fastest observer beside `law_rad_per_s`, within
/// `bounds`, by which the sensor's noise shakes a joint by no more than `max_noise_m_per_s` and whose margins
/// hold. Its velocity estimate is kEvenVelocityOverObserver times as fast.
struct ObserverBounds {
  double min_rad_per_s, max_rad_per_s;
};
inline constexpr double kEvenVelocityOverObserver = 3.0;
LoopBandwidths design_even_loop(const LoopConditions& conditions, double law_rad_per_s,
                                double max_noise_m_per_s, const ObserverBounds& bounds);

/// Conditions of a robot: drive delay and sensor of its file, and 3 % of the motors' peak force for the
/// noise.
LoopConditions loop_conditions(const robot::RobotModel& model, double control_hz);

/// Throws StartupError if the drive's delay is too long for a rate. `rate`: the setting's name.
void require_short_delay(const LoopConditions& conditions, const char* rate = "control_hz");

/// Throws StartupError if the drive's delay is too long, or these bandwidths make a loop that is not stable
/// on a robot that is off its file (kWorstInertiaRatio). `law`, `observer`: the settings' names.
void require_stable(const LoopConditions& conditions, const LoopBandwidths& bandwidths, const char* law,
                    const char* observer);

/// The joint controller with these bandwidths; it knows the drive's delay.
JointAccelerationSettings joints_of(const robot::RobotModel& model, const LoopBandwidths& bandwidths,
                                    double control_hz);

/// What a hand does to a robot of these conditions when it lets go, in innovations of the observer: more than
/// a fifth of the motors' peak force, and than 12 rms of the reading's noise; no more than twice the peak
/// force for two samples.
AbruptForce letting_go(const LoopConditions& conditions);

}  // namespace telekerf::control
