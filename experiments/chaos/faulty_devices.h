// SPDX-License-Identifier: Apache-2.0
// Devices that fail when they are told to: joint sensors, laser, button. Each is driven by a struct that
// outlives it.
#pragma once

#include <cstdint>
#include <memory>

#include "common/robot/drivers/drive.h"
#include "common/robot/robot_model.h"
#include "master/operator/operator_input.h"
#include "slave/laser/laser.h"

namespace telekerf::experiments {

/// What the joint sensors do wrong.
struct SensorFault {
  bool dropout = false;
  bool stuck = false;
  double held_m =
      0.0;  ///< what the first joint's sensor said last; it says so on, whoever asks, while it sticks
  Vec3 slip_m = Vec3::Zero();
};

/// What the laser does wrong, and what it was told and gave at the last step. It measures its light; its
/// supply goes by the enable counter.
struct LaserState {
  bool deaf = false;   ///< it gives what it was told last, until it is without word for too long
  bool stuck = false;  ///< it gives light as long as it is supplied
  double told_w = 0.0;
  double emitted_w = 0.0;
  int unheard = 0;  ///< steps since it heard anything
};

/// A laser without word for so many steps is dark (docs/how-to/add-a-laser.md).
inline constexpr int kSilentLaserSteps = 3;

/// A simulated robot, `truth`, at rest with its tool at `tool_in_base_m`, or in the middle of its workspace
/// where that pose cannot be taken.
robot::Drive faulty_drive(const robot::RobotModel& truth, std::uint64_t seed, const Vec3& tool_in_base_m,
                          SensorFault& fault);
std::unique_ptr<laser::Laser> faulty_laser(LaserState& state);
std::unique_ptr<master::OperatorInput> scripted_button(const bool& pressed);

}  // namespace telekerf::experiments
