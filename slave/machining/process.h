// SPDX-License-Identifier: Apache-2.0
// telekerf-slave --automatic: machines the contour that vision publishes, then reports.
#pragma once

#include <string>

#include "common/bus/bus_flags.h"
#include "common/robot/supervisor.h"
#include "common/runtime/settings.h"
#include "slave/laser/laser_output.h"

namespace telekerf::machining {

struct AutomaticSettings {
  double speed_mm_s = 8.0;
  std::string controller = "auto";
  std::string corner = "rounded";
  std::string material = "wood";
  std::string sensor = "hall";  ///< what the simulated robot has, whatever its file says
  double kerf_um = 0.0;         ///< closed contours are moved by half of it
  bool no_framing = false;
  double wait_s = 20.0;          ///< for vision, then it gives up
  double machining_hz = 2400.0;  ///< control rate
  void declare(Settings& settings);
};

/// Of the robot in the process, as the slave has them anyway.
struct AutomaticRobot {
  std::string robot = "slave-keops";
  robot::RobotSupervisorSettings machine;
  double mismatch = 0.1;
  std::uint64_t seed = 1;
  double laser_w = 10.0;
  laser::LaserOutputSettings beam;
};

/// Waits for a picture's contours, works them off, writes result.json, timing.json, trace.csv, mark.png and
/// depth.png into `folder` (empty: none). Returns 0 when all were finished, 1 when it was stopped or the beam
/// left the corridor. Throws StartupError, also when the drive or the laser was lost.
int run_automatic(const BusSettings& bus_settings, const AutomaticSettings& settings,
                  const AutomaticRobot& robot, const std::string& folder);

}  // namespace telekerf::machining
