// SPDX-License-Identifier: Apache-2.0
// The subcommands of telekerf-inspect; each adds itself to the program.
#pragma once

#include "common/runtime/program.h"

namespace telekerf::inspect {

void add_codec_command(Program& program);
void add_contour_command(Program& program);
void add_drive_command(Program& program);
void add_efd_command(Program& program);
void add_export_command(Program& program);
void add_inputs_command(Program& program);
void add_label_command(Program& program);
void add_recover_command(Program& program);
void add_robot_command(Program& program);
void add_run_command(Program& program);
void add_runs_command(Program& program);

}  // namespace telekerf::inspect
