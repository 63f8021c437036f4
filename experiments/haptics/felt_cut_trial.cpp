// SPDX-License-Identifier: Apache-2.0
#include "experiments/haptics/felt_cut_trial.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/reporting/run_report.h"
#include "common/workpiece/line_depth.h"
#include "experiments/simulation/simulation.h"

namespace telekerf::experiments {
namespace {

/// What the tool gave to the hand up to each row: a row's force acts while the tool goes on to the next row's
/// place.
void meter(const RunRecord& record, FeltCutRun& run) {
  double given_j = 0.0;
  for (std::size_t i = 0; i + 1 < record.master.size(); ++i) {
    const MasterRow &row = record.master[i], &next = record.master[i + 1];
    if (!row.guided) continue;
    given_j -= row.hand_n.dot(next.tool_m - row.tool_m);
    run.most_given_j = std::max(run.most_given_j, given_j);
    if (i % 10 == 0) {
      run.time_s.push_back(row.t_s);
      run.given_j.push_back(given_j);
    }
  }
}

double metric(const RunRecord& record, const char* name) {
  const auto found = record.master_figures.find(name);
  return found == record.master_figures.end() ? 0.0 : found->second;
}

/// Places lit on either side as well: the ends of a stretch are only partly cut.
std::vector<double> lit_depths(const RemoteMark& mark) {
  std::vector<double> out;
  const std::size_t bins = mark.depth_m.size();
  for (std::size_t i = 0; i < bins; ++i)
    if (mark.dwell_s_per_m[i] > 0.0 && mark.dwell_s_per_m[(i + 1) % bins] > 0.0 &&
        mark.dwell_s_per_m[(i + bins - 1) % bins] > 0.0)
      out.push_back(mark.depth_m[i]);
  return out;
}

/// And all others that the beam has touched at all.
std::vector<double> marked_depths(const RemoteMark& mark) {
  std::vector<double> out;
  std::copy_if(mark.depth_m.begin(), mark.depth_m.end(), std::back_inserter(out),
               [](double depth_m) { return depth_m > 0.0; });
  return out;
}

/// Rms of depth / `depth_m` - 1.
double depth_error(const std::vector<double>& depths, double depth_m) {
  double squares = 0.0;
  for (const double depth : depths) squares += (depth / depth_m - 1.0) * (depth / depth_m - 1.0);
  return depths.empty() ? NAN : std::sqrt(squares / static_cast<double>(depths.size()));
}

}  // namespace

FeltCutRun run_felt_cut(const FeltCutTrial& trial, bool felt, std::uint64_t seed, double heat_factor) {
  simulation::SimulationSettings settings;
  settings.image = trial.image;
  settings.network = netem::load_profile(trial.netem);
  settings.seed = seed;
  settings.duration_s = trial.duration_s;
  settings.master.beta = trial.beta;
  settings.master.hand_speed_mm_s = trial.hand_speed_mm_s;
  settings.slave.node.laser_w = trial.laser_w;
  const workpiece::Material& copy = workpiece::kWood;
  if (felt) settings.master.felt_depth_mm = trial.depth_mm;
  settings.master.felt_depth_speed_mm2_per_s = 1e6 * workpiece::depth_speed_m2_per_s(copy, trial.laser_w);
  const RunRecord record = simulation::simulate(settings);
  const auto report = reporting::make_report(record);

  workpiece::Material truth = copy;
  truth.heat_of_removal_j_per_m3 *= heat_factor;
  FeltCutRun run{.felt = felt,
                 .motion = remote_motion(record),
                 .mark = burn_record(record, truth, BeamPower::kConstant, trial.laser_w),
                 .time_s = {},
                 .given_j = {}};
  const std::vector<double> depths = lit_depths(run.mark);
  for (const double depth : depths) run.mean_depth_m += depth / static_cast<double>(depths.size());
  run.depth_error = depth_error(depths, 1e-3 * trial.depth_mm);
  const std::vector<double> marked = marked_depths(run.mark);
  run.marked_error = depth_error(marked, 1e-3 * trial.depth_mm);
  run.lit_places = depths.size();
  run.marked_places = marked.size();
  meter(record, run);
  run.wished_rms_n = metric(record, "felt_wished_rms_n");
  run.felt_rms_n = metric(record, "felt_rms_n");
  run.held_back_share = metric(record, "felt_held_back_share");
  run.port_most_given_j = metric(record, "felt_most_given_j");
  run.tracking_rms_um = report["tracking"]["rms_um"].get<double>();
  run.energy_outside_j = report["cut"]["energy_outside_corridor_j"].get<double>();
  return run;
}

}  // namespace telekerf::experiments
