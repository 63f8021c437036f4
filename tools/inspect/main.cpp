// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect: offline tools that look at one thing and print one JSON object.
#include "tools/inspect/commands.h"

int main(int argc, char** argv) {
  CLI::App app("Looks at robots, contours, codecs and finished runs", "telekerf-inspect");
  app.require_subcommand(1);
  telekerf::Action action;
  telekerf::inspect::add_codec_command(app, action);
  telekerf::inspect::add_contour_command(app, action);
  telekerf::inspect::add_efd_command(app, action);
  telekerf::inspect::add_robot_command(app, action);
  telekerf::inspect::add_run_command(app, action);
  return telekerf::run_program(app, argc, argv, action);
}
