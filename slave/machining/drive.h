// SPDX-License-Identifier: Apache-2.0
// Acceleration control for a loop with a known delay: currents that are computed at one sample act some
// samples later, and the disturbance observer must know when.
#pragma once

#include <array>

#include "common/control/disturbance_observer.h"
#include "common/robot/dynamics.h"
#include "common/robot/robot.h"

namespace telekerf::machining {

using robot::DeltaState;
using robot::Mat3;

/// Most samples between a reading and the effect of the currents that answer it.
inline constexpr int kMaxLoopDelay = 4;

/// A_n of eq. 21.
enum class NominalInertia : std::uint8_t {
  kDiagonal,  ///< one constant a joint; the coupling is left to the observer (thesis 4.1)
  kModel,     ///< A(q) of the robot's file
};

struct DriveSettings {
  control::DisturbanceObserver::Gains observer{
      .period_s = 1.0 / 2400.0, .bandwidth_rad_per_s = 300.0, .velocity_bandwidth_rad_per_s = 700.0};
  NominalInertia inertia = NominalInertia::kModel;
  int loop_delay = 0;  ///< samples, 0..kMaxLoopDelay
};

/// Order within a step: observe(reading), compute a desired acceleration from state(), currents(...), write.
class Drive {
 public:
  Drive(const robot::RobotModel& nominal, const DriveSettings& settings) noexcept;

  /// At rest at the measured joints; the disturbance starts from zero.
  void reset(const Vec3& joints_m) noexcept;
  /// Returns false if the measured joints are no pose of this robot (state() keeps the last one).
  bool observe(const robot::JointReading& reading) noexcept;
  /// Observed joints and velocities, and all maps there; base frame.
  const DeltaState& state() const noexcept { return state_; }
  const Vec3& disturbance_n() const noexcept { return observer_.disturbance_n(); }

  /// Currents for a desired joint acceleration (eq. 24), A, all of the estimated disturbance put back.
  /// `known_n`: force that the model expects beside inertia; the observer then estimates the rest only. What
  /// is not finite becomes zero.
  Vec3 currents(const Vec3& desired_joint_acceleration_m_per_s2, const Vec3& known_n) noexcept;
  /// True if a motor was at its limit in the last step.
  bool saturated() const noexcept { return saturated_; }

 private:
  robot::RobotModel model_;
  robot::DeltaKinematics kinematics_;
  DriveSettings settings_;
  control::DisturbanceObserver observer_;
  DeltaState state_;
  Mat3 diagonal_kg_ = Mat3::Identity();
  std::array<Vec3, kMaxLoopDelay + 1> sent_n_;  ///< on their way, beyond the known ones, newest first
  bool saturated_ = false;
};

}  // namespace telekerf::machining
