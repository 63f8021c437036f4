// SPDX-License-Identifier: Apache-2.0
// The subcommands of telekerf-netem; each adds itself to the program.
#pragma once

#include "common/runtime/program.h"

namespace telekerf::netem {

void add_link_command(Program& program);
void add_tc_command(Program& program);
void add_verify_command(Program& program);
void add_trace_command(Program& program);
void add_list_command(Program& program);
void add_replay_command(Program& program);
void add_switch_command(Program& program);

}  // namespace telekerf::netem
