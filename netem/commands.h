// SPDX-License-Identifier: Apache-2.0
// The subcommands of telekerf-netem; each sets `action` when it is chosen.
#pragma once

#include <fmt/format.h>

#include <string>

#include "common/runtime/program.h"
#include "netem/random.h"

namespace telekerf::netem {

inline void add_direction(CLI::App& command, Direction& direction) {
  const auto read = [&direction](const std::string& word) {
    if (word != "forward" && word != "backward") {
      throw CLI::ValidationError("--direction", fmt::format("'{}' is neither forward nor backward", word));
    }
    direction = word == "forward" ? Direction::kForward : Direction::kBackward;
  };
  command.add_option_function<std::string>("--direction", read, "forward (operator to slave, default) or backward");
}

/// Refuses what is not a number as well, which CLI::Range lets pass.
inline CLI::Validator within(double low, double high) {
  return CLI::Validator(
      [low, high](const std::string& text) {
        double value = 0.0;
        const bool good = CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
        return good ? std::string() : fmt::format("{} does not lie within [{:g}, {:g}]", text, low, high);
      },
      "NUMBER");
}
/// Whole numbers; CLI11 alone would take -1 for the largest of them.
inline CLI::Validator whole_number() {
  return CLI::Validator(
      [](const std::string& text) {
        const bool good = !text.empty() && text.find_first_not_of("0123456789") == text.npos;
        return good ? std::string() : fmt::format("'{}' is no whole number of 0 or more", text);
      },
      "NUMBER");
}

void add_link_command(CLI::App& app, Action& action);
void add_tc_command(CLI::App& app, Action& action);
void add_verify_command(CLI::App& app, Action& action);
void add_trace_command(CLI::App& app, Action& action);
void add_list_command(CLI::App& app, Action& action);
void add_replay_command(CLI::App& app, Action& action);
void add_switch_command(CLI::App& app, Action& action);

}  // namespace telekerf::netem
