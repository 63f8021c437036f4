// SPDX-License-Identifier: Apache-2.0
// The subcommands of telekerf-netem; each sets `action` when it is chosen.
#pragma once

#include <fmt/format.h>

#include <string>

#include "common/runtime/program.h"
#include "netem/core/random.h"

namespace telekerf::netem {

inline void add_direction(CLI::App& command, Direction& direction) {
  const auto read = [&direction](const std::string& word) {
    const auto known = kDirections.find(word);
    if (!known)
      throw CLI::ValidationError("--direction", fmt::format("'{}' is neither forward nor backward", word));
    direction = *known;
  };
  command.add_option_function<std::string>("--direction", read,
                                           "forward (operator to slave, default) or backward");
}

void add_link_command(CLI::App& app, Action& action);
void add_tc_command(CLI::App& app, Action& action);
void add_verify_command(CLI::App& app, Action& action);
void add_trace_command(CLI::App& app, Action& action);
void add_list_command(CLI::App& app, Action& action);
void add_replay_command(CLI::App& app, Action& action);
void add_switch_command(CLI::App& app, Action& action);

}  // namespace telekerf::netem
