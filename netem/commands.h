// SPDX-License-Identifier: Apache-2.0
// The subcommands of telekerf-netem; each adds itself to the program.
#pragma once

#include "common/runtime/program.h"
#include "netem/core/random.h"

namespace telekerf::netem {

inline constexpr EnumRow<Direction> kDirectionRows[] = {
    {"forward", Direction::kForward, "operator to slave"},
    {"backward", Direction::kBackward, "slave to operator"},
};
inline constexpr EnumTable<Direction> kDirections(kDirectionRows);

void add_link_command(Program& program);
void add_tc_command(Program& program);
void add_verify_command(Program& program);
void add_trace_command(Program& program);
void add_list_command(Program& program);
void add_replay_command(Program& program);
void add_switch_command(Program& program);

}  // namespace telekerf::netem
