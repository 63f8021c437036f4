// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment lap: the demo's lap in virtual time, with the same report.
#include <fmt/format.h>

#include <filesystem>

#include "common/reporting/run_report.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "experiments/commands.h"
#include "experiments/lap_options.h"
#include "experiments/quick_form.h"
#include "experiments/replay/virtual_run.h"
#include "experiments/simulation/simulation.h"

namespace telekerf::experiments {
namespace {

struct Options : LapOptions, QuickForm {
  bool record = false;
  std::string out = "out/lap";
  std::string config;
};

int run(Options& options) {
  const simulation::SimulationSettings lap = options.prepared();
  const ContourMessage contour = simulation::find_contour(lap);
  const RunRecord record = simulation::simulate(lap, contour);
  make_folder("--out", options.out);
  if (options.record) {
    write_contour(options.out, record);
    write_master(options.out, record);
    write_slave(options.out, record);
    write_virtual_run(options.out, record, contour, {options.config, options.netem});
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
  o.add_parameters(s);
  o.add_quick(s, {QuickForm::shorter("duration_s", o.lap.duration_s, 5)});
  s.add("record", o.record,
        "leaves the record beside the report: master.h5, slave.h5, contour.csv, master.csv, slave.csv");
  s.add("out", o.out, kFolder, "folder for the results");
}

}  // namespace

void add_lap_command(Program& program) {
  program.add("lap", "Picture to cut in virtual time: report.json, trace.csv, cut.png", Options{},
              add_parameters, run);
}

}  // namespace telekerf::experiments
