// SPDX-License-Identifier: Apache-2.0
// telekerf-netem: the network between the two machines, emulated, exported, measured and recorded.
#include "netem/commands/commands.h"

int main(int argc, char** argv) {
  CLI::App app("Emulates the network between the operator's and the slave's machine", "telekerf-netem");
  app.require_subcommand(1);
  telekerf::Action action;
  telekerf::netem::add_link_command(app, action);
  telekerf::netem::add_tc_command(app, action);
  telekerf::netem::add_verify_command(app, action);
  telekerf::netem::add_trace_command(app, action);
  telekerf::netem::add_replay_command(app, action);
  telekerf::netem::add_list_command(app, action);
  telekerf::netem::add_switch_command(app, action);
  return telekerf::run_program(app, argc, argv, action);
}
