// SPDX-License-Identifier: Apache-2.0
// Preview control of open contours (eq. 29-35, fig. 4.2): joint control whose velocity and acceleration
// references are read ahead.
//
// The thesis reads them one and two samples ahead. On a plant without delay that is a bias of about -K_p2 T
// qdd / K_p1; the steps ahead must match the loop: velocity none, acceleration what passes until the force
// acts, plus half of the sample over which it is held.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "slave/machining/follower_settings.h"
#include "slave/machining/tracking.h"

namespace telekerf::machining {

struct PreviewControl {
  double convergence_rad_s = 60.0;  ///< lambda of eq. 30
  double slope_rad_s = 60.0;        ///< S_p2^-1 S_p1: weight of position against velocity in eq. 29
  double velocity_ahead = 0.0;      ///< samples
  double acceleration_ahead = 0.5;  ///< samples
  /// Finite-time convergence (eq. 35): mu sign(epsilon), made continuous within `layer_m_per_s`. 0: off.
  double reaching_m_per_s2 = 0.0;
  double layer_m_per_s = 2e-3;

  /// Steps ahead for a loop whose currents act `loop_delay` samples after the reading.
  static PreviewControl tuned(const PathFollowerSettings& s) noexcept {
    PreviewControl control;
    control.convergence_rad_s = control.slope_rad_s = s.along_rad_s;
    control.acceleration_ahead = s.preview ? s.loop_delay + 0.5 : 0.0;
    return control;
  }

  Vec3 update(const Tracking& now) const noexcept {
    const JointReference q = joint_reference(now, now.trajectory.at(now.tick));
    const JointReference v =
        velocity_ahead == 0.0 ? q : joint_reference(now, now.trajectory.at(now.tick + velocity_ahead));
    const JointReference a = joint_reference(now, now.trajectory.at(now.tick + acceleration_ahead));
    if (!q.good || !v.good || !a.good) return Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    const Vec3 position_error = q.position_m - now.measured.joints_m;
    const Vec3 velocity_error = v.velocity_m_per_s - now.measured.joint_velocity_m_per_s;
    Vec3 out = a.acceleration_m_per_s2 + (slope_rad_s + convergence_rad_s) * velocity_error +
               convergence_rad_s * slope_rad_s * position_error;  // eq. 32-34
    if (reaching_m_per_s2 > 0.0) {
      const Vec3 epsilon = velocity_error + slope_rad_s * position_error;
      for (int i = 0; i < 3; ++i) {
        out[i] += reaching_m_per_s2 * std::clamp(epsilon[i] / layer_m_per_s, -1.0, 1.0);
      }
    }
    return out;
  }
};

}  // namespace telekerf::machining
