// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment lap: the demo's lap in virtual time, with the same report.
#include <fmt/format.h>

#include <filesystem>

#include "common/reporting/run_report.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "experiments/commands.h"
#include "experiments/simulation/simulation.h"

namespace telekerf::experiments {
namespace {

struct Options {
  simulation::SimulationSettings lap;
  std::string netem = "thesis-constant";
  bool record = false;
  std::string out = "out/lap";
};

int run(Options& options) {
  simulation::SimulationSettings& lap = options.lap;
  lap.slave.mismatch = lap.master.mismatch;
  lap.slave.node.control_hz = lap.master.node.control_hz;
  lap.slave.node.stream_hz = lap.master.node.stream_hz;
  options.lap.network = netem::load_profile(options.netem);
  const RunRecord record = simulation::simulate(options.lap);
  make_folder("--out", options.out);
  if (options.record) {
    write_contour(options.out, record);
    write_master(options.out, record);
    write_slave(options.out, record);
  }
  const auto report = reporting::write_report(options.out, record);
  fmt::print("{}\n", json_text(report));
  const auto& age = report["link"]["command_age_ms"];
  if (age["mean"].is_number() && age["mean"].get<double>() > age["beam"].get<double>()) {
    fmt::print(stderr,
               "the beam stays off while commands are older than {:.0f} ms there and back, and here they are "
               "{:.0f} ms old in the mean: --slave-beam-age-s allows more\n",
               age["beam"].get<double>(), age["mean"].get<double>());
  }
  return reporting::succeeded(report) ? 0 : 1;
}

void add_parameters(Options& o, Settings& s) {
  auto& lap = o.lap;
  s.add("image", lap.image, kPicture, "picture: a shipped name or a file");
  s.add("width_mm", lap.width_mm, {.min = 0, .max = 1000, .unit = "mm"},
        "width of the whole picture, 0: fitted to the workspace");
  s.add("master_robot", lap.master.robot, kRobot, "the operator's: a shipped name or a file");
  s.add("slave_robot", lap.slave.robot, kRobot, "the workpiece's: a shipped name or a file");
  s.add("netem", o.netem, kProfile, "network profile: a shipped name or a file");
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
  s.add("duration_s", lap.duration_s, {.min = 1, .max = 600, .unit = "s"}, "length of the run");
  s.add("record", o.record, "leaves the record beside the report: contour.csv, master.csv, slave.csv");
  s.add("out", o.out, kFolder, "folder for the results");
}

}  // namespace

void add_lap_command(Program& program) {
  program.add("lap", "Picture to cut in virtual time: report.json, trace.csv, cut.png", Options{},
              add_parameters, run);
}

}  // namespace telekerf::experiments
