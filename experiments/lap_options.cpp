// SPDX-License-Identifier: Apache-2.0
#include "experiments/lap_options.h"

namespace telekerf::experiments {

void LapOptions::add_parameters(Settings& s) {
  s.add("image", lap.image, kPicture, "picture: a shipped name or a file");
  s.add("width_mm", lap.width_mm, {.min = 0, .max = 1000, .unit = "mm"},
        "width of the whole picture, 0: fitted to the workspace");
  s.add("master_robot", lap.master.robot, kRobot, "the operator's: a shipped name or a file");
  s.add("slave_robot", lap.slave.robot, kRobot, "the workpiece's: a shipped name or a file");
  s.add("netem", netem, kProfile, "network profile: a shipped name or a file");
  s.add("seed", lap.seed, kSeeds, "of everything random");
  s.add("beta", lap.master.beta, {.min = master::kSmallestBeta, .max = master::kLargestBeta},
        "slave motion = beta x master motion");
  s.add("mismatch", lap.master.mismatch, {.min = 0, .max = 0.5},
        "how far the simulated robots are off their files, as a share");
  s.add("control_hz", lap.master.node.control_hz, {.min = 200, .max = 20000, .unit = "Hz"},
        "control rate of both sides, a multiple of stream_hz");
  s.add("stream_hz", lap.master.node.stream_hz, {.min = 100, .max = 10000, .unit = "Hz"},
        "samples a second in either stream");
  lap.master.add_stream_parameters(s);
  lap.master.add_guidance_parameters(s);
  s.prefix("slave_");
  lap.slave.add_node_parameters(s);
  s.only_with({"bare_accelerations"}, "law", {"remote-acceleration"});
  s.prefix("");
  s.not_with({"image", "width_mm"}, kReplays, {"contour"});
  s.not_with({"hand_speed_mm_s", "hand_sideways_n", "control_hz"}, kReplays,
             {"hand"});  // a row a control step
  s.add("duration_s", lap.duration_s, {.min = 1, .max = 600, .unit = "s"}, "length of the run");
}

simulation::SimulationSettings LapOptions::prepared() const {
  simulation::SimulationSettings all = lap;
  all.slave.mismatch = lap.master.mismatch;
  all.slave.node.control_hz = lap.master.node.control_hz;
  all.slave.node.stream_hz = lap.master.node.stream_hz;
  all.network = netem::load_profile(netem);
  return all;
}

}  // namespace telekerf::experiments
