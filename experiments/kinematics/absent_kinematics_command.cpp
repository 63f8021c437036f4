// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment kinematics in a build without MuJoCo: says what is missing.
#include "common/runtime/startup_error.h"
#include "experiments/commands.h"

namespace telekerf::experiments {
namespace {

struct Options {};

}  // namespace

void add_kinematics_command(Program& program) {
  program.add(
      "kinematics", "Thesis 8.4 (not in this build: MuJoCo was missing)", Options{},
      [](Options&, Settings&) {},
      [](const Options&) -> int {
        throw environment_error(
            "this build has no MuJoCo: install libmujoco-dev (./telekerf setup does) and build again");
      });
}

}  // namespace telekerf::experiments
