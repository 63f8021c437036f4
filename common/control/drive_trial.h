// SPDX-License-Identifier: Apache-2.0
// A gentle motion by which a drive tells how old its readings are: the robot holds its pose, slowly, while
// every joint is shaken by sines of its own. What was commanded and what was read is kept for drive_delay.h.
//
// Nothing in it needs the delay: the hold is far slower than any drive's delay, and the sines lie far above
// the hold.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/control/joint_acceleration_control.h"

namespace telekerf::control {

struct DriveTrialSettings {
  double control_hz = 1000.0;
  double force_n = 0.0;     ///< largest of the shaking, a motor; 0: 40 % of what it bears for good
  double travel_m = 4e-3;   ///< a joint that is read farther than this from its first place ends the trial
  double settle_s = 1.0;    ///< hold alone, until the weight is known
  double duration_s = 4.0;  ///< shaking
};

/// One control step of a trial.
struct DriveSample {
  Vec3 joints_m;               ///< as read
  Vec3 acceleration_m_per_s2;  ///< of the joints by the force that answers this reading, after the robot's
                               ///< file
  bool valid;                  ///< there was a new reading
};

class DriveTrial {
 public:
  static constexpr std::size_t kSines = 6;  ///< a joint

  DriveTrial(const robot::RobotModel& nominal, const DriveTrialSettings& settings);

  enum class State : std::uint8_t {
    kRunning,
    kDone,
    kTooFar,  ///< a joint left its travel: currents are zero from then on
    kNoPose,  ///< the readings are no pose of this robot: likewise
  };

  /// One control step: currents that answer the reading, A; zero before the first reading and after the end.
  /// Allocates nothing.
  Vec3 step(const robot::JointReading& reading) noexcept;

  State state() const noexcept { return state_; }
  /// The shaking's steps.
  const std::vector<DriveSample>& samples() const noexcept { return samples_; }
  /// Largest force of the shaking, N: as asked for, or less where a joint would swing too far.
  double force_n() const noexcept { return force_n_; }
  /// How far any joint was read from its first place, m.
  double farthest_m() const noexcept { return farthest_m_; }
  double highest_hz() const noexcept { return highest_hz_; }

 private:
  void begin(const Vec3& joints_m) noexcept;
  Vec3 shaking_n() const noexcept;

  robot::RobotModel model_;
  DriveTrialSettings settings_;
  robot::DeltaKinematics kinematics_;
  JointAccelerationControl joints_;
  double period_s_;
  double highest_hz_;
  std::array<std::array<double, kSines>, 3> sine_hz_{};
  double force_n_ = 0.0;
  Vec3 start_m_ = Vec3::Zero();
  double farthest_m_ = 0.0;
  bool started_ = false;
  std::size_t steps_ = 0, settle_steps_, all_steps_;
  State state_ = State::kRunning;
  std::vector<DriveSample> samples_;
};

}  // namespace telekerf::control
