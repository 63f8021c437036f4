// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment kinematics in a build without MuJoCo: says what is missing.
#include "common/runtime/startup_error.h"
#include "experiments/commands.h"

namespace telekerf::experiments {

void add_kinematics_command(CLI::App& app, Action& action) {
  auto* command = app.add_subcommand("kinematics", "Thesis 8.4 (not in this build: MuJoCo was missing)");
  command->allow_extras();
  command->callback([&action] {
    action = []() -> int {
      throw StartupError(
          "this build has no MuJoCo: install libmujoco-dev (./telekerf setup does) and build again");
    };
  });
}

}  // namespace telekerf::experiments
