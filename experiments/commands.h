// SPDX-License-Identifier: Apache-2.0
// The subcommands of telekerf-experiment; each adds itself to the program.
#pragma once

#include "common/runtime/program.h"

namespace telekerf::experiments {

void add_all_command(Program& program);
void add_autofocus_command(Program& program);
void add_chaos_command(Program& program);
void add_closed_contour_command(Program& program);
void add_codec_command(Program& program);
void add_constraint_command(Program& program);
void add_contours_command(Program& program);
void add_delay_command(Program& program);
void add_hall_sensor_command(Program& program);
void add_haptics_command(Program& program);
void add_kinematics_command(Program& program);
void add_lap_command(Program& program);
void add_machine_command(Program& program);
void add_open_contour_command(Program& program);
void add_pictures_command(Program& program);
void add_replay_command(Program& program);
void add_remote_machining_command(Program& program);
void add_robots_command(Program& program);
void add_space_contour_command(Program& program);

}  // namespace telekerf::experiments
