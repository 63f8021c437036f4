// SPDX-License-Identifier: Apache-2.0
// The subcommands of telekerf-netem; each sets `action` when it is chosen.
#pragma once

#include <map>
#include <string>

#include "common/runtime/program.h"
#include "netem/random.h"

namespace telekerf::netem {

/// The words of --direction.
inline const std::map<std::string, Direction> kDirectionNames{{"forward", Direction::kForward},
                                                              {"backward", Direction::kBackward}};

void add_link_command(CLI::App& app, Action& action);
void add_tc_command(CLI::App& app, Action& action);
void add_verify_command(CLI::App& app, Action& action);
void add_trace_command(CLI::App& app, Action& action);
void add_list_command(CLI::App& app, Action& action);
void add_replay_command(CLI::App& app, Action& action);
void add_switch_command(CLI::App& app, Action& action);

}  // namespace telekerf::netem
