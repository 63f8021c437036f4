// SPDX-License-Identifier: Apache-2.0
// telekerf-netem: the network between the two machines, emulated, exported, measured and recorded.
#include "netem/commands/commands.h"

int main(int argc, char** argv) {
  telekerf::Program program("telekerf-netem",
                            "Emulates the network between the operator's and the slave's machine");
  telekerf::netem::add_link_command(program);
  telekerf::netem::add_tc_command(program);
  telekerf::netem::add_verify_command(program);
  telekerf::netem::add_trace_command(program);
  telekerf::netem::add_replay_command(program);
  telekerf::netem::add_list_command(program);
  telekerf::netem::add_switch_command(program);
  return program.run(argc, argv);
}
