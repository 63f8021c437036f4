// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect: tools that look at one thing and print what they find.
#include "tools/inspect/commands.h"

int main(int argc, char** argv) {
  telekerf::Program program("telekerf-inspect",
                            "Looks at robots, drives, input devices, contours, codecs and finished runs");
  telekerf::inspect::add_codec_command(program);
  telekerf::inspect::add_contour_command(program);
  telekerf::inspect::add_drive_command(program);
  telekerf::inspect::add_efd_command(program);
  telekerf::inspect::add_export_command(program);
  telekerf::inspect::add_inputs_command(program);
  telekerf::inspect::add_label_command(program);
  telekerf::inspect::add_recover_command(program);
  telekerf::inspect::add_robot_command(program);
  telekerf::inspect::add_run_command(program);
  telekerf::inspect::add_runs_command(program);
  return program.run(argc, argv);
}
