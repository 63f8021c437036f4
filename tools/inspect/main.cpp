// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect: offline tools that look at one thing and print one JSON object.
#include "tools/inspect/commands.h"

int main(int argc, char** argv) {
  telekerf::Program program("telekerf-inspect", "Looks at robots, contours, codecs and finished runs");
  telekerf::inspect::add_codec_command(program);
  telekerf::inspect::add_contour_command(program);
  telekerf::inspect::add_efd_command(program);
  telekerf::inspect::add_robot_command(program);
  telekerf::inspect::add_run_command(program);
  return program.run(argc, argv);
}
