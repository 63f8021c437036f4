// SPDX-License-Identifier: Apache-2.0
// What every program shares: --help, --version, one sentence on stderr and exit code 2 when it cannot work.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace telekerf {

/// What the command line asked for; returns the exit code (0 good, 1 a bad verdict).
using Action = std::function<int()>;

/// Parses, runs `action` (set before, or by the callback of a chosen subcommand), reports a StartupError.
/// Exit codes: `contract.md`; usage errors are 2 as well.
int run_program(CLI::App& app, int argc, char** argv, Action& action);

/// Bounds of an option, inclusive; refuses what is not a number as well, which CLI::Range lets pass.
CLI::Validator within(double low, double high);
/// Whole numbers; CLI11 alone would take -1 for the largest of them.
CLI::Validator whole_number();

}  // namespace telekerf
