// SPDX-License-Identifier: Apache-2.0
// A robot's workspace drawn from above and from the side.
#pragma once

#include <filesystem>

#include "common/robot/robot_model.h"

namespace telekerf::inspect {

/// Writes a PNG: reachable poses coloured by condition number in the plane z = centre (left) and y = centre
/// (right), the workspace's cylinder outlined, rails and tool drawn at the centre. Throws StartupError if it
/// cannot be written.
void draw_workspace(const robot::RobotModel& robot, const std::filesystem::path& file);

}  // namespace telekerf::inspect
