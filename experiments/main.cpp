// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment: the experiments, in virtual time.
#include "experiments/commands.h"

int main(int argc, char** argv) {
  telekerf::Program program("telekerf-experiment", "Experiments in virtual time");
  telekerf::experiments::add_all_command(program);
  telekerf::experiments::add_autofocus_command(program);
  telekerf::experiments::add_chaos_command(program);
  telekerf::experiments::add_closed_contour_command(program);
  telekerf::experiments::add_codec_command(program);
  telekerf::experiments::add_constraint_command(program);
  telekerf::experiments::add_contours_command(program);
  telekerf::experiments::add_delay_command(program);
  telekerf::experiments::add_hall_sensor_command(program);
  telekerf::experiments::add_haptics_command(program);
  telekerf::experiments::add_kinematics_command(program);
  telekerf::experiments::add_lap_command(program);
  telekerf::experiments::add_machine_command(program);
  telekerf::experiments::add_open_contour_command(program);
  telekerf::experiments::add_pictures_command(program);
  telekerf::experiments::add_replay_command(program);
  telekerf::experiments::add_remote_machining_command(program);
  telekerf::experiments::add_robots_command(program);
  telekerf::experiments::add_space_contour_command(program);
  return program.run(argc, argv);
}
