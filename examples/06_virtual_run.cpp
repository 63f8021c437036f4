// SPDX-License-Identifier: Apache-2.0
// A whole run without hardware, network or waiting: both stations and the emulated network in one thread.
//
// A simulated hand guides the pen round a heart for ten seconds; the slave cuts behind 50 ms of network each
// way. After six seconds the operator says stop. You see how true the three links of the chain are, and that
// the laser is off from the stop on.
#include <fmt/format.h>

#include "common/reporting/run_report.h"
#include "experiments/simulation/simulation.h"

int main() {
  using namespace telekerf;
  simulation::SimulationSettings settings;
  settings.image = "heart";
  settings.network = netem::load_profile("thesis-constant");
  settings.duration_s = 10.0;
  settings.seed = 7;
  const double stop_s = 6.0;
  settings.stops.push_back({stop_s, {.number = 1, .cleared = {}}});

  const RunRecord record = simulation::simulate(settings);
  const auto report = reporting::make_report(record);
  for (const char* part : {"constraint", "tracking", "cut"}) {
    fmt::print("{:10}  rms {:5.1f} um, max {:5.1f} um\n", part, report[part].value("rms_um", 0.0),
               report[part].value("max_um", 0.0));
  }

  double before_j = 0.0, after_j = 0.0;
  const double period_s = 1.0 / report["loop"]["slave"].value("rate_hz", 1000.0);
  for (const SlaveRow& row : record.slave) {
    (row.t_s - record.slave.front().t_s < stop_s + 1e-3 ? before_j : after_j) += row.laser_w * period_s;
  }
  fmt::print("laser       {:.1f} J before the stop, {:.1f} J after it\n", before_j, after_j);
  return before_j > 0.0 && after_j == 0.0 && reporting::stayed_inside(report) ? 0 : 1;
}
