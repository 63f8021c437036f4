// SPDX-License-Identifier: Apache-2.0
// The subcommands of telekerf-inspect; each declares its options and, when chosen, sets the action.
#pragma once

#include "common/runtime/program.h"

namespace telekerf::inspect {

void add_codec_command(CLI::App& app, Action& action);
void add_contour_command(CLI::App& app, Action& action);
void add_efd_command(CLI::App& app, Action& action);
void add_robot_command(CLI::App& app, Action& action);
void add_run_command(CLI::App& app, Action& action);

}  // namespace telekerf::inspect
