// SPDX-License-Identifier: Apache-2.0
// From what a user names as `drive` to a robot. A vendor enters his machine in drives.cpp, and nowhere else.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/robot/drivers/simulated_robot.h"
#include "common/robot/robot.h"
#include "common/robot/robot_model.h"

namespace telekerf::robot {

/// A robot as a station gets it.
struct Drive {
  std::unique_ptr<Robot> robot;
  /// The same robot if it is simulated in this process: only then can it be moved in time, its tool be pushed
  /// and the truth be known.
  SimulatedRobot* plant = nullptr;
};

/// Of a simulated robot.
struct Simulation {
  double mismatch = 0.1;  ///< how far it is off its file, as a share
  std::uint64_t seed = 1;
  std::optional<Sensor::Kind> sensor;  ///< what reads its joints, whatever its file says
};

/// How a `drive` may be written, one form after the other.
std::string drive_forms();
/// What is wrong with a `drive` as a user wrote it, and the remedy; empty: nothing.
std::string complaint_about_drive(const std::string& drive);

/// `nominal`: what the controllers know of the robot. `control_hz`: how often it will be read and written.
/// Throws StartupError.
Drive attach(const std::string& drive, const RobotModel& nominal, double control_hz,
             const Simulation& simulation);

}  // namespace telekerf::robot
