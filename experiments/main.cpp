// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment: the experiments, in virtual time.
#include "experiments/commands.h"

int main(int argc, char** argv) {
  CLI::App app("Experiments in virtual time", "telekerf-experiment");
  app.require_subcommand(1);
  telekerf::Action action;
  telekerf::experiments::add_closed_contour_command(app, action);
  telekerf::experiments::add_codec_command(app, action);
  telekerf::experiments::add_constraint_command(app, action);
  telekerf::experiments::add_contours_command(app, action);
  telekerf::experiments::add_delay_command(app, action);
  telekerf::experiments::add_kinematics_command(app, action);
  telekerf::experiments::add_lap_command(app, action);
  telekerf::experiments::add_open_contour_command(app, action);
  telekerf::experiments::add_space_contour_command(app, action);
  return telekerf::run_program(app, argc, argv, action);
}
