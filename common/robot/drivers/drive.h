// SPDX-License-Identifier: Apache-2.0
// What a drive is to a station, and the row by which users name it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "common/robot/robot.h"
#include "common/robot/robot_model.h"
#include "common/runtime/device_registry.h"

namespace telekerf::robot {

class SimulatedRobot;

/// A robot as a station gets it.
struct Drive {
  std::unique_ptr<Robot> robot;
  /// The same robot if it is simulated in this process: only then can it be moved in time, its tool be pushed
  /// and the truth be known.
  SimulatedRobot* plant = nullptr;
};

/// Of a simulated robot.
struct Simulation {
  double mismatch = 0.1;  ///< how far it is off its file, as a fraction
  std::uint64_t seed = 1;
  std::optional<Sensor::Kind> sensor;  ///< what reads its joints, whatever its file says
};

/// What a drive is opened with beside the rest of its name.
struct DriveNeeds {
  const RobotModel& nominal;  ///< what the controllers know of the robot
  double control_hz;          ///< how often it will be read and written
  Simulation simulation;      ///< for a robot that is simulated here; others leave it alone
};

using DriveRegistry = DeviceRegistry<Drive, const DriveNeeds&>;
using DriveKind = DriveRegistry::Kind;

}  // namespace telekerf::robot
