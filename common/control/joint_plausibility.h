// SPDX-License-Identifier: Apache-2.0
// Can a reading be true? Of a robot that nobody pushes, the joints are where their currents have moved them:
// what the disturbance observer's model does not explain has bounds. A sensor that slips leaves them at once,
// one that sticks within milliseconds, because the controller then pushes a joint that seems not to move.
#pragma once

#include <cstdint>

#include "common/control/disturbance_observer.h"
#include "common/robot/robot.h"
#include "common/robot/robot_model.h"
#include "common/robot/runaway.h"

namespace telekerf::control {

/// Innovation gate of a disturbance observer, and a bound on the acceleration that it estimates beside the
/// model. The bounds follow from the robot's file with a margin for a robot that is 30 % off it (as
/// require_stable()): 15 rms of the reading's noise; friction that turns round; a share of each change of the
/// currents. No allocation, lock or throw.
class JointPlausibility {
 public:
  JointPlausibility(const robot::RobotModel& nominal, const DisturbanceObserver::Gains& observer) noexcept;

  /// At rest at the measured joints; nothing is judged before the observer has settled.
  void reset() noexcept;
  /// Every step, between the observer's prediction and its correction: may it be corrected? False where
  /// nothing was read, or where the joints cannot be; several such readings in a row are a doubt.
  bool accepts(const robot::JointReading& reading, const DisturbanceObserver& predicted) noexcept;
  /// After the correction: the acceleration that the observer estimates beside the model, m/s^2. As long as
  /// it is beyond its bound for a few steps in a row, that is a doubt.
  void unexplained(const Vec3& acceleration_m_per_s2) noexcept;

  /// For good; kNone: the robot does what it is told.
  const robot::Doubt& doubt() const noexcept { return doubt_; }

 private:
  Vec3 bound_m(const robot::JointReading& reading, const Vec3& velocity_m_per_s) const noexcept;

  double period_s_;
  double noise_m_;
  double friction_m_per_s2_;
  double change_m_per_s2_;       ///< that the gate bears beside friction
  double unexplained_m_per_s2_;  ///< that the estimate may come to
  double peak_m_per_s2_;
  int settling_ = 0;  ///< steps until it judges
  int steps_ = 0;     ///< since the last reading that was accepted
  std::int64_t time_ns_ = 0;
  Vec3 acceleration_m_per_s2_ = Vec3::Zero();  ///< by the currents, a step before
  Vec3 unsettled_m_per_s2_ = Vec3::Zero();     ///< changes of the currents' acceleration, fading
  int rejected_ = 0;                           ///< in a row
  int pushed_ = 0;                             ///< steps in a row
  robot::Doubt doubt_;
};

}  // namespace telekerf::control
