// SPDX-License-Identifier: Apache-2.0
// Can a reading be true? Of a robot that nobody pushes, the joints are where their currents have moved them:
// what the disturbance observer's model does not explain has bounds. A sensor that slips leaves them at once,
// one that sticks within milliseconds, because the controller then pushes a joint that seems not to move. One
// that sticks from the start on seems to have no weight, while the other joints have theirs.
#pragma once

#include <cstdint>

#include "common/control/disturbance_observer.h"
#include "common/robot/robot.h"
#include "common/robot/robot_model.h"
#include "common/robot/runaway.h"

namespace telekerf::control {

/// Innovation gate of a disturbance observer, and a bound on how fast its estimate may change. Both follow
/// from the robot's file, with a margin for a robot that is 30 % off it (as require_stable()): 15 rms of the
/// reading's noise, friction that turns round, and a share of what is asked of the motors. No allocation,
/// lock or throw.
class JointPlausibility {
 public:
  JointPlausibility(const robot::RobotModel& nominal, const DisturbanceObserver::Gains& observer) noexcept;

  /// At rest at the measured joints. Readings are judged as soon as some in a row are where the observer
  /// expects them, forces when it has settled.
  void reset() noexcept;
  /// Every step, between the observer's prediction and its correction: may it be corrected? False where
  /// nothing was read, or where the joints cannot be.
  bool accepts(const robot::JointReading& reading, const DisturbanceObserver& predicted) noexcept;
  /// After the correction: the acceleration that the observer estimates beside the model, and the weight that
  /// the model has in it, both against the joints' motion, m/s^2. False: it has changed by more than can be,
  /// or a joint has not the weight that the others have.
  bool explains(const Vec3& disturbance_m_per_s2, const Vec3& weight_m_per_s2) noexcept;
  /// What is asked of the joints in this step, m/s^2.
  void asked(const Vec3& acceleration_m_per_s2) noexcept;

  /// After two readings in a row or one force that cannot be, for good; kNone: the robot does what it is
  /// told.
  const robot::Doubt& doubt() const noexcept { return doubt_; }

 private:
  /// Nothing speaks for a reading yet, or, after one that the device took at another time, not again.
  bool unsure() const noexcept { return settling_ > 0 && expected_ < kExpected; }
  /// False, for the caller to return.
  bool note(robot::Doubt::Kind kind, int joint, double value) noexcept;
  Vec3 gate_m(const robot::JointReading& reading, const Vec3& velocity_m_per_s) const noexcept;

  double period_s_;
  double noise_m_;
  double usual_m_per_s2_;                ///< changes of the disturbance that the model does not know of
  double noise_m_per_s2_;                ///< of the estimate
  double fastest_m_per_s_;               ///< that a joint may be found moving at
  double peak_m_per_s2_;                 ///< by the motors' peak force
  double slow_share_, forget_;           ///< a step
  static constexpr int kExpected = 5;    ///< readings in a row
  int expected_ = 0;                     ///< readings in a row that are where they are to be, so many at most
  int settled_ = 0;                      ///< readings that the observer takes for it
  int settling_ = 0;                     ///< readings until forces are judged, and readings in any case
  int steps_ = 0;                        ///< since the last reading that was accepted
  std::int64_t time_ns_ = 0;             ///< of that one, by the device
  Vec3 forced_m_per_s2_ = Vec3::Zero();  ///< by the currents, a step before
  Vec3 unsettled_m_per_s2_ = Vec3::Zero();  ///< changes of that, fading
  Vec3 asked_m_per_s2_ = Vec3::Zero();      ///< fading
  Vec3 slow_m_per_s2_ = Vec3::Zero();       ///< the disturbance's slow mean
  int doubted_ = 0;                         ///< steps in a row
  robot::Doubt doubt_;
};

}  // namespace telekerf::control
