// SPDX-License-Identifier: Apache-2.0
// Independent joint control, the baseline: each joint follows its own reference of the same tick (eq. 32),
// unless its acceleration is read ahead.
#pragma once

#include <cmath>
#include <limits>

#include "slave/machining/follower_settings.h"
#include "slave/machining/tracking.h"

namespace telekerf::machining {

struct IndependentControl {
  double bandwidth_rad_s = 60.0;    ///< K_p1 = bandwidth^2
  double damping = 1.0;             ///< K_p2 = 2 damping bandwidth
  double acceleration_ahead = 0.0;  ///< samples, as in preview control

  static IndependentControl tuned(const PathFollowerSettings& s) noexcept {
    IndependentControl control{.bandwidth_rad_s = s.along_rad_s};
    if (s.preview && s.independent_model != ModelUse::kNone) control.acceleration_ahead = s.loop_delay + 0.5;
    return control;
  }

  Vec3 update(const Tracking& now) const noexcept {
    const JointReference q = joint_reference(now, now.trajectory.at(now.tick));
    const JointReference a = acceleration_ahead == 0.0
                                 ? q
                                 : joint_reference(now, now.trajectory.at(now.tick + acceleration_ahead));
    if (!q.good || !a.good) return Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    return a.acceleration_m_per_s2 +
           2.0 * damping * bandwidth_rad_s * (q.velocity_m_per_s - now.measured.joint_velocity_m_per_s) +
           bandwidth_rad_s * bandwidth_rad_s * (q.position_m - now.measured.joints_m);
  }
};

}  // namespace telekerf::machining
