// SPDX-License-Identifier: Apache-2.0
// The robot of a station, whatever drives it: watched, and without current while nobody knows where it
// stands.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/robot/drivers/drives.h"
#include "common/robot/runaway.h"

namespace telekerf {
class Settings;
}

namespace telekerf::robot {

struct RobotSupervisorSettings {
  RobotSupervisorSettings() =
      default;                      // no aggregate: g++ 12 warns of its text within temporaries of settings
  std::string drive = "simulated";  ///< see drives.h
  double drive_stale_s = 0.02;      ///< steps of so much time without a new reading: failed
  void add_parameters(Settings& settings);
};

/// Order within a control step: read(), decide, write(), advance(). None of them allocates, waits or throws
/// beyond what the drive itself does.
class RobotSupervisor {
 public:
  /// A robot that is not simulated must tell where it stands, see wait_until_ready(), and keep up with the
  /// rate. `pushed`: by an operator's hand. Throws StartupError.
  RobotSupervisor(const RobotModel& nominal, const RobotSupervisorSettings& settings, double control_hz,
                  Drive drive, Pushed pushed = Pushed::kNo);
  ~RobotSupervisor() { release(); }
  RobotSupervisor(const RobotSupervisor&) = delete;
  RobotSupervisor& operator=(const RobotSupervisor&) = delete;

  struct InitialPose {
    Vec3 joints_m;
    Vec3 tool_m;  ///< workpiece frame
  };
  /// Where the robot stands before the loop starts; there is no current meanwhile. Waits. Throws StartupError
  /// if it does not tell, or if its file knows no such pose.
  InitialPose wait_until_ready();

  /// Valid only if it is new. One that is not finite is a failure.
  JointReading read() noexcept;
  /// Nothing but zero reaches the motors before the first reading and after the failure.
  void write(const Vec3& currents_a) noexcept;
  /// Between read() and write(), with a valid reading: where the tool is, workpiece frame. A tool that runs
  /// away is a failure, and so is what the controller finds that cannot be.
  void watch(const Vec3& tool_m, const Doubt& doubt = {}) noexcept {
    runaway_.at(tool_m);
    runaway_.doubted(doubt);
  }
  /// A plant moves on by one control period; a real machine does so by itself.
  void advance() noexcept;
  /// After the last step: leaves the robot without current.
  void release() noexcept { drive_.robot->write(Vec3::Zero()); }

  /// The loop has had a reading.
  bool started() const noexcept { return started_; }
  /// For good: no reading has come for `drive_stale_s`, one was not finite, or the robot ran away.
  bool failed() const noexcept { return missing_ >= patience_ || runaway_.tripped(); }
  /// What has failed and what to do, one sentence.
  std::string failure() const;

  /// Steps without a reading, all in all.
  std::uint64_t readings_missed() const noexcept { return missed_; }
  /// What came in the drive's place and was refused, see Robot::refused().
  std::uint64_t refused() const noexcept { return drive_.robot->refused(); }

  /// Null unless the robot is simulated in this process: its hand's force, its time, its truth.
  SimulatedRobot* plant() const noexcept { return drive_.plant; }
  /// Workpiece frame; none: nobody knows it, and the measured tool is all there is.
  std::optional<Vec3> true_tool_m() const noexcept;
  std::optional<Vec3> true_tool_velocity_m_per_s() const noexcept;

 private:
  JointReading newest() noexcept;

  RobotSupervisorSettings settings_;
  RobotModel nominal_;
  double period_s_;
  std::uint64_t patience_;  ///< steps
  Drive drive_;
  std::optional<std::uint64_t> newest_tick_;
  std::uint64_t missing_ = 0;  ///< steps in a row without a reading
  std::uint64_t missed_ = 0;
  bool started_ = false;
  RunawayWatch runaway_;
};

}  // namespace telekerf::robot
