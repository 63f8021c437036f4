// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment chaos: faults of many seeds against both stations in virtual time.
#include <fmt/format.h>

#include <cstdio>

#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "experiments/chaos/chaos_report.h"
#include "experiments/chaos/shrink.h"
#include "experiments/commands.h"
#include "experiments/quick_form.h"
#include "experiments/result_file.h"

namespace telekerf::experiments {
namespace {

struct Options : QuickForm {
  ChaosCampaign campaign;
  std::string faults;
  bool no_shrink = false;
  double beam_age_s = CheckerSettings{}.gate_s;
  std::string out = "out/chaos";
};

/// Before any folder is made.
void require_room(const ChaosSettings& each) {
  const double least_s = shortest_s(each.mode);
  if (each.duration_s >= least_s) return;
  throw usage_error(
      fmt::format("duration_s = {:g}: must be at least {:g} with mode = {}, as the last third, 7 s at the "
                  "least, heals what "
                  "faults before it have done; use a longer one, or --mode safety",
                  each.duration_s, least_s, kChaosModes.word(each.mode)));
}

int run(Options& options) {
  require_room(options.campaign.each);
  make_folder("--out", options.out);
  ChaosCampaign& campaign = options.campaign;
  if (!options.faults.empty()) campaign.kinds = parse_faults(options.faults);
  campaign.shrinks = !options.no_shrink;
  campaign.each.set_gate(options.beam_age_s);
  const auto all = static_cast<std::size_t>(campaign.runs);
  ChaosReport report = run_campaign(campaign, [all](std::size_t done) {
    if (done % 50 == 0) fmt::print(stderr, "{} of {}\n", done, all);
  });
  write_result(std::filesystem::path(options.out) / "chaos.json", report.json, campaign.seed);
  nlohmann::ordered_json summary = report.json;
  summary.erase("failures");
  fmt::print("{}\n", json_text(summary));
  for (const std::string& sentence : report.sentences) fmt::print("{}\n", sentence);
  return report.passed ? 0 : 1;
}

std::string complaint(const std::string& faults) {
  try {
    if (!faults.empty()) (void)parse_faults(faults);
  } catch (const StartupError& error) {
    return error.what();
  }
  return "";
}

void add_parameters(Options& o, Settings& s) {
  ChaosCampaign& c = o.campaign;
  s.add("runs", c.runs, {.min = 1, .max = 1e6}, "how many, with the seeds from --seed on");
  s.add("seed", c.seed, kSeeds, "of the first run");
  o.add_quick(s, {QuickForm::shorter("runs", c.runs, 5)});
  s.add("duration_s", c.each.duration_s, {.min = 1, .max = 600, .unit = "s"}, "length of a run");
  s.add("mode", c.each.mode, kChaosModes, "what becomes of the faults");
  s.add("faults", o.faults, {.form = "none|FAULT,FAULT...", .complaint = complaint},
        "these in every run (docs/results/chaos.md lists them); empty: each seed draws its own");
  s.add("beam_age_s", o.beam_age_s, {.min = 0.02, .max = 2, .unit = "s"},
        "oldest command that the beam may be on for, at both sites as for who judges");
  s.add("no_shrink", o.no_shrink, "leaves the command line of a missed bar as long as it is");
  s.add("jobs", c.jobs, {.min = 0, .max = 256}, "runs at a time, 0: one a processor");
  s.add("out", o.out, kFolder, "folder for the results");
}

}  // namespace

void add_chaos_command(Program& program) {
  program.add("chaos", "Faults of many seeds in virtual time: chaos.json; exit code 1 if a bar is missed",
              Options{}, add_parameters, run);
}

}  // namespace telekerf::experiments
