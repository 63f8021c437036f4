// SPDX-License-Identifier: Apache-2.0
// What is measured of a machined contour (thesis 8.1, 8.2): errors, speed, burn; the same words for the
// process and for experiments (docs/reference/report.md lists them).
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/workpiece/material.h"
#include "slave/machining/timed_path.h"

namespace telekerf::machining {

/// One tick with the beam released, workpiece frame; tool and its velocity are the truth where it is known.
struct PassRow {
  Reference reference;
  Vec3 tool_m = Vec3::Zero();
  Vec3 tool_velocity_m_per_s = Vec3::Zero();
  double laser_w = 0.0;
  Vec3 error_in_frame_m = Vec3::Zero();  ///< reference minus tool: along, across, binormal
};

PassRow pass_row(const Reference& reference, const Vec3& tool_m, const Vec3& tool_velocity_m_per_s,
                 double laser_w) noexcept;

/// From a contour's start to its end.
struct ContourPass {
  const TimedPath* plan = nullptr;
  const geometry::Polyline* contour = nullptr;  ///< what was to be cut: the extracted points
  std::vector<PassRow> rows;
};

/// Errors, speeds and corners of all passes together (flat contours). A pass that was stopped counts as far
/// as it came.
nlohmann::ordered_json measure(std::span<const ContourPass> passes, double speed_m_per_s);

/// What the beam left: joules, depth and kerf along the paths; writes mark.png and depth.png into the folder.
/// Throws StartupError.
nlohmann::ordered_json burn(std::span<const ContourPass> passes, const workpiece::Material& material,
                            const std::filesystem::path& folder);

/// Vertices where the contour turns by more than 30 degrees within 0.3 mm.
std::vector<Vec2> corners_of(const geometry::Polyline& contour);

}  // namespace telekerf::machining
