// SPDX-License-Identifier: Apache-2.0
// One contour machined in virtual time, and what is measured of it (thesis 8.1, 8.2).
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/robot/robot_model.h"
#include "slave/machining/contour_pass.h"
#include "slave/machining/path_follower.h"

namespace telekerf::experiments {

struct ContourRunSettings {
  machining::TimedPathSettings plan;
  machining::PathFollowerSettings follower;
  machining::ControllerKind controller = machining::ControllerKind::kAuto;
  std::string robot = "slave-keops";
  /// true: no friction, no mismatch, ideal sensors; false: all of them, and Hall sensors.
  bool ideal = false;
  bool perfect_sensor = false;  ///< the full plant, but its joints are read without error
  double mismatch = 0.1;
  std::uint64_t seed = 1;
  double laser_w = 10.0;
};

struct ContourRun {
  machining::ContourPass pass;  ///< refers to the plan and the contour that it was given
  double time_s = 0.0;          ///< run-up, contour, run-out
  int limit_violations =
      0;  ///< ticks with a motor, the speed or the acceleration at its limit, or off stroke
};

/// The plant of a run: the robot of the file made worse, or made ideal.
robot::RobotModel true_robot(const robot::RobotModel& nominal, const ContourRunSettings& settings);

/// The run's follower with the bandwidths for its speed and corners, and for the Hall sensors that read the
/// joints.
machining::PathFollowerSettings tuned_follower(robot::RobotModel nominal, const ContourRunSettings& settings);

/// Runs a plan. Throws StartupError if the path leaves the workspace.
ContourRun run_contour(const machining::TimedPath& plan, const geometry::Polyline& contour,
                       const ContourRunSettings& settings);

/// The measures of one run against the extracted points (flat contours), names as in
/// docs/reference/report.md.
nlohmann::ordered_json measure(const ContourRun& run, const ContourRunSettings& settings);

void write_contour_trace(const ContourRun& run, const std::filesystem::path& csv);

}  // namespace telekerf::experiments
