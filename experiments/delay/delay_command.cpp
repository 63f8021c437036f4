// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment delay: every law and estimator across every delay; docs/results/delay.md explains the
// rows.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/reporting/page_tables.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "experiments/commands.h"
#include "experiments/delay/delay_figures.h"
#include "experiments/delay/delay_runs.h"
#include "experiments/delay/delay_tables.h"
#include "experiments/quick_form.h"
#include "experiments/result_file.h"

namespace telekerf::experiments {
namespace {

struct Options : QuickForm {
  DelayTrial trial;
  std::string netem;
  std::optional<double> rtt_ms, jitter_ms, loss;  // without them: no condition
  std::optional<double> duration_s;
  std::vector<double> only_rtt_ms;
  std::uint64_t seed = 1;
  std::string page;
  std::string out = "out/delay";
};

void add_conditions(Options& o, Settings& s) {
  o.trial.master.add_stream_parameters(s);
  s.add("netem", o.netem, kProfile, "network profile: a shipped name or a file");
  s.add("rtt_ms", o.rtt_ms, {.min = 0, .max = 10000, .unit = "ms"},
        "round trip; without it 0 if another condition is given");
  s.add("jitter_ms", o.jitter_ms, {.min = 0, .max = 10000, .unit = "ms"},
        "one way, standard deviation; without it 0");
  s.add("loss", o.loss, {.min = 0, .max = 1}, "as a fraction; without it 0");
  s.prefix("slave_");
  o.trial.slave.add_node_parameters(s);
  s.only_with({"bare_accelerations"}, "law", {"remote-acceleration"});
  s.prefix("");
}

/// Some condition or setting of the trial is given.
bool asks_for_one(Options options) {
  Settings given, shipped;
  Options defaults;
  add_conditions(options, given);
  add_conditions(defaults, shipped);
  return given.json() != shipped.json();
}

void add_parameters(Options& o, Settings& s) {
  add_conditions(o, s);
  s.add("duration_s", o.duration_s, {.min = 2, .max = 600, .unit = "s"},
        "length of a run; without it 8, on a profile 30");
  s.add("only_rtt_ms", o.only_rtt_ms, 0, {.min = 0, .max = 1000, .unit = "ms"},
        "all rivals at these round trips, 10 % jitter and 1 % loss, and no tables; none: everything");
  s.add("seed", o.seed, kSeeds, "of everything random");
  // One run is short.
  const auto take_one_rtt = [&o] {
    if (!asks_for_one(o)) o.only_rtt_ms = {100.0};
  };
  o.add_quick(s, {{"only_rtt_ms", "100", take_one_rtt}}, {"page"});
  s.add("page", o.page, kFile, "results page whose tables are written anew; one run has none");
  s.add("out", o.out, kFolder, "folder for the results");
}

Run one_run(const Options& options) {
  Run run;
  run.trial = options.trial;
  run.trial.seed = options.seed;
  run.rival = {run.trial.master.node.command.law, run.trial.master.node.command.observer.estimator,
               run.trial.slave.node.bare_accelerations};
  run.codec = run.trial.master.codec;
  run.rtt_ms = options.rtt_ms.value_or(0.0);
  run.jitter_ms = options.jitter_ms.value_or(0.0);
  run.loss = options.loss.value_or(0.0);
  run.trial.network = netem::simple_profile(run.rtt_ms * 1e-3, run.jitter_ms * 1e-3, run.loss);
  if (!options.netem.empty()) {
    if (options.rtt_ms || options.jitter_ms || options.loss) {
      throw usage_error(
          "--netem says everything about the network: give either it or --rtt-ms, --jitter-ms, --loss");
    }
    run.profile = std::filesystem::path(options.netem).stem().string();
    run.trial.network = netem::load_profile(options.netem);
  }
  if (!options.page.empty()) throw usage_error("--page wants all runs: leave out what asks for one");
  run.tuning = tuning_of(run.trial);
  run.duration_s = options.duration_s.value_or(options.netem.empty() ? Length{}.grid_s : Length{}.profile_s);
  run.result = run_trial(record_hand("heart", run.duration_s, options.seed), run.trial);
  return run;
}

std::vector<Run> all_runs(const Options& options) {
  Length length;
  if (options.duration_s) length.grid_s = length.profile_s = *options.duration_s;
  length.only_rtt_ms = options.only_rtt_ms;
  return full_benchmark(length, options.seed, [](std::size_t done, std::size_t of) {
    fmt::print("{} of {}\n", done, of);
    std::fflush(stdout);
  });
}

void print_row(const Run& run) {
  const std::string network = run.profile.empty() ? fmt::format("{:.0f} ms, jitter {:.0f} ms, loss {:g}",
                                                                run.rtt_ms, run.jitter_ms, run.loss)
                                                  : run.profile;
  fmt::print(
      "{:<33}{:<20}{:<6}{:<34}{:<18}tracking {:9.1f} um (max {:.0f}), "
      "prediction {:9.1f} um, {}\n",
      law_of(run.rival), word_of(run.rival.estimator), codec::kCodecs.word(run.codec), network, run.condition,
      run.result.tracking_rmse_um, run.result.tracking_max_um, run.result.prediction_rmse_um,
      run.result.stable ? "stable" : "NOT STABLE");
}

int run(Options& options) {
  const auto begin = std::chrono::steady_clock::now();
  const std::filesystem::path folder = options.out;
  refuse_unwritable("--out", folder);
  const bool one = asks_for_one(options);
  const bool some = !options.only_rtt_ms.empty();
  if (one && some)
    throw usage_error("--only-rtt-ms is of all rivals: leave it out, or what asks for one run");
  if (some && !options.page.empty()) throw usage_error("--page wants all runs: leave --only-rtt-ms out");
  const std::vector<Run> runs = one ? std::vector<Run>{one_run(options)} : all_runs(options);
  make_folder("--out", folder);
  nlohmann::ordered_json json;
  json["rows"] = nlohmann::ordered_json::array();
  for (const Run& run : runs) json["rows"].push_back(row_of(run));
  write_result(folder / "delay.json", json, options.seed);
  if (!one) {
    draw_rtt(runs, folder / "delay.png");
    draw_stability(folder / "stability.png");
    draw_start(folder / "start.png");
    const std::vector<reporting::PageTable> tables =
        some ? std::vector<reporting::PageTable>() : delay_tables(runs);
    if (!options.page.empty()) reporting::write_tables(options.page, tables);
    for (const auto& table : tables) fmt::print("{}\n{}\n", table.name, table.markdown);
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  write_json(folder / "timing.json",
             nlohmann::ordered_json{{"seconds", took.count()}, {"runs", runs.size()}});
  bool good = true;
  for (const Run& run : runs) {
    if (one || some || !run.condition.empty()) print_row(run);
    // The bar of its own: the default law is stable everywhere.
    if (one || same(run.rival, rivals().front())) good = good && run.result.stable;
  }
  fmt::print("{} runs in {:.0f} s: {}/delay.json\n", runs.size(), took.count(), options.out);
  return good ? 0 : 1;
}

}  // namespace

void add_delay_command(Program& program) {
  program.add(
      "delay",
      "Laws and estimators across delays: delay.json, plots, tables; any condition or setting given: one run",
      Options{}, add_parameters, run);
}

}  // namespace telekerf::experiments
