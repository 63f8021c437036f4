// SPDX-License-Identifier: Apache-2.0
// One contour machined in virtual time, and what is measured of it (thesis 8.1, 8.2).
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/robot/robot_model.h"
#include "slave/automatic/follower.h"

namespace telekerf::experiments {

struct ContourRunSettings {
  slave::PlanSettings plan;
  slave::FollowerSettings follower;
  slave::ControllerKind controller = slave::ControllerKind::kAuto;
  std::string robot = "slave-keops";
  /// true: no friction, no mismatch, ideal sensors; false: all of them, and Hall sensors.
  bool ideal = false;
  double mismatch = 0.1;
  std::uint64_t seed = 1;
  double laser_w = 10.0;
};

/// One tick of the pass, workpiece frame; tool and its velocity are the truth.
struct ContourRow {
  double t_s = 0.0;
  slave::Reference reference;
  Vec3 tool_m = Vec3::Zero();
  Vec3 tool_velocity_m_per_s = Vec3::Zero();
  double laser_w = 0.0;
  Vec3 error_in_frame_m = Vec3::Zero();  ///< reference minus tool: along, across, binormal
};

struct ContourRun {
  std::vector<ContourRow> rows;  ///< from the contour's start to its end
  double time_s = 0.0;           ///< run-up, contour, run-out
  int limit_violations =
      0;  ///< ticks with a motor, the speed or the acceleration at its limit, or off stroke
};

/// The plant of a run: the robot of the file made worse, or made ideal.
robot::RobotModel true_robot(const robot::RobotModel& nominal, const ContourRunSettings& settings);

/// Runs a plan. Throws Refusal if the path leaves the workspace.
ContourRun run_contour(const slave::Plan& plan, const ContourRunSettings& settings);

/// The measures of one run against the extracted points (flat contours), names as in docs/machining.md.
nlohmann::ordered_json measure(const ContourRun& run, const slave::Plan& plan,
                               const geometry::Polyline& contour, const ContourRunSettings& settings);

void write_contour_trace(const ContourRun& run, const std::filesystem::path& csv);

/// Vertices where the contour turns by more than 30 degrees within 0.3 mm.
std::vector<Vec2> corners_of(const geometry::Polyline& contour);

}  // namespace telekerf::experiments
