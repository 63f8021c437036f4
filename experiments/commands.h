// SPDX-License-Identifier: Apache-2.0
// The subcommands of telekerf-experiment; each declares its options and, when chosen, sets the action.
#pragma once

#include "common/runtime/program.h"

namespace telekerf::experiments {

void add_closed_contour_command(CLI::App& app, Action& action);
void add_codec_command(CLI::App& app, Action& action);
void add_constraint_command(CLI::App& app, Action& action);
void add_contours_command(CLI::App& app, Action& action);
void add_delay_command(CLI::App& app, Action& action);
void add_kinematics_command(CLI::App& app, Action& action);
void add_lap_command(CLI::App& app, Action& action);
void add_open_contour_command(CLI::App& app, Action& action);
void add_space_contour_command(CLI::App& app, Action& action);

}  // namespace telekerf::experiments
