// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/program.h"

#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "common/runtime/refusal.h"
#include "common/runtime/version.h"

namespace telekerf {

int run_program(CLI::App& app, int argc, char** argv, Action& action) {
  constexpr int kCannot = 2;
  app.set_version_flag("--version", std::string(kVersion));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    fmt::print(stderr, "{}: {}; see --help\n", app.get_name(), error.what());
    return kCannot;
  }
  try {
    return action();
  } catch (const Refusal& refusal) {
    fmt::print(stderr, "{}: {}\n", app.get_name(), refusal.what());
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: unexpected: {}\n", app.get_name(), error.what());
  }
  return kCannot;
}

}  // namespace telekerf
