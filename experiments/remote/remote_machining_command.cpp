// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment remote-machining: thesis 8.3, two contours cut by hand from afar.
#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "common/reporting/plot.h"
#include "common/reporting/run_report.h"
#include "common/runtime/resources.h"
#include "common/runtime/results.h"
#include "common/runtime/settings.h"
#include "common/runtime/startup_error.h"
#include "experiments/commands.h"
#include "experiments/quick_form.h"
#include "experiments/remote/remote_figure.h"
#include "experiments/result_file.h"
#include "experiments/simulation/simulation.h"

namespace telekerf::experiments {
namespace {

using nlohmann::ordered_json;

struct Options : QuickForm {
  std::vector<std::string> netem{"ideal", "thesis-constant", "thesis-tcp"};
  double duration_s = 13.0;  ///< about one round: what the button left out stays visible
  double laser_w = 10.0;
  bool all_profiles = false;
  std::uint64_t seed = 1;
  std::string out = "out/remote-machining";
};

struct Experiment {
  const char* name;
  const char* figure;
  const char* image;
  double beta;
};
/// The thesis' pictures are not printed legibly: these are ours, its scaling factors are its own.
constexpr std::array kExperiments{Experiment{"experiment-1", "8.7", "heart", 0.5},
                                  Experiment{"experiment-2", "8.8", "blob", 2.0 / 3.0}};

std::string name_of(const std::string& netem) { return std::filesystem::path(netem).stem().string(); }

RunRecord run_of(const Experiment& experiment, const std::string& netem, const Options& options) {
  simulation::SimulationSettings settings;
  settings.image = experiment.image;
  settings.master.beta = experiment.beta;
  settings.network = netem::load_profile(netem);
  settings.duration_s = options.duration_s;
  settings.seed = options.seed;
  settings.slave.node.laser_w = options.laser_w;
  return simulation::simulate(settings);
}

/// What the run's own report says of the three links of the chain, and of the beam.
ordered_json measures(const RunRecord& record) {
  const ordered_json report = reporting::make_report(record);
  ordered_json out;
  for (const char* part : {"beta", "constraint", "tracking", "cut"}) out[part] = report[part];
  out["rtt_ms"] = report["link"]["rtt_ms"];
  out["total_ms"] = report["link"]["total_ms"];
  out["lost"] = report["link"]["lost"];
  out["button"] = button_json(record);
  return out;
}

/// One network: its figures, and what figures are drawn of.
struct OneRun {
  ordered_json figures;
  std::vector<RemoteSample> motion;
  RemoteMarks marks;
};

OneRun one_run(const Experiment& experiment, const RunRecord& record, const Options& options) {
  const auto burnt = [&](const workpiece::Material& material, BeamPower power) {
    return burn_record(record, material, power, options.laser_w);
  };
  OneRun out{.figures = {{"image", experiment.image}},
             .motion = remote_motion(record),
             .marks = {.fibreglass = burnt(workpiece::kFibreglass, BeamPower::kConstant),
                       .wood = burnt(workpiece::kWood, BeamPower::kConstant),
                       .wood_by_speed = burnt(workpiece::kWood, BeamPower::kRecorded)}};
  out.figures.update(measures(record));
  out.figures["speed"] = speed_json(out.motion);
  out.figures["measured_beta"] = measured_beta(out.motion);
  out.figures["depth"] = {{"fibreglass", mark_json(out.marks.fibreglass)},
                          {"wood", mark_json(out.marks.wood)},
                          {"wood_power_by_speed", mark_json(out.marks.wood_by_speed)}};
  return out;
}

/// Figure 8.7 or 8.8 on this network.
ordered_json shown_run(const Experiment& experiment, const std::string& netem, const Options& options) {
  const RunRecord record = run_of(experiment, netem, options);
  const OneRun run = one_run(experiment, record, options);
  const std::filesystem::path folder = options.out;
  write_atomically(folder / fmt::format("motion-{}-{}.csv", experiment.name, name_of(netem)),
                   motion_csv(record));
  draw_remote(fmt::format("{} ({}): {}, beta {:.3g}, network {}", experiment.name, experiment.figure,
                          experiment.image, experiment.beta, name_of(netem)),
              run.motion, run.marks,
              folder / fmt::format("figure-{}-{}.png", experiment.figure, name_of(netem)));
  return run.figures;
}

/// Figure 8.6: the pictures that the contours come from.
void draw_pictures(const std::filesystem::path& folder) {
  reporting::Figure figure{.columns = 2};
  for (std::size_t i = 0; i < kExperiments.size(); ++i)
    figure.panels.push_back({.title = fmt::format("({}) experiment {}", "AB"[i], i + 1),
                             .picture = find_resource("pictures", kExperiments[i].image, ".png")});
  reporting::draw_figure(figure, folder / "figure-8.6.png");
}

/// A row a shipped network; what a run cannot be finished on says why. Speeds and depths of all of them in
/// two figures.
ordered_json every_network(const Experiment& experiment, const Options& options) {
  ordered_json out;
  std::vector<NetworkRun> runs;
  for (const std::string& profile : shipped_names("profiles", ".toml")) {
    try {
      OneRun run = one_run(experiment, run_of(experiment, profile, options), options);
      out[profile] = std::move(run.figures);
      runs.push_back({profile, std::move(run.motion), std::move(run.marks.wood)});
    } catch (const StartupError& error) {
      out[profile] = {{"ended", error.what()}, {"cut", nullptr}};
    }
  }
  const std::filesystem::path folder = options.out;
  draw_network_speeds(fmt::format("{}: tangential velocity on every network", experiment.name), runs,
                      folder / fmt::format("figure-{}-speeds.png", experiment.figure));
  draw_network_depths(fmt::format("{}: depth in wood on every network, constant power", experiment.name),
                      runs, folder / fmt::format("figure-{}-depths.png", experiment.figure));
  return out;
}

int run(const Options& options) {
  const std::filesystem::path folder = options.out;
  make_folder("--out", folder);
  ordered_json result{
      {"experiment", "remote-machining"}, {"duration_s", options.duration_s}, {"laser_w", options.laser_w}};
  draw_pictures(folder);
  bool good = true;
  for (const Experiment& experiment : kExperiments) {
    for (const std::string& netem : options.netem) {
      ordered_json& at = result[experiment.name][name_of(netem)];
      at = shown_run(experiment, netem, options);
      good = good && reporting::succeeded(at) && at["button"]["beam_ticks_without_button"] == 0;
    }
    if (options.all_profiles) result["profiles"][experiment.name] = every_network(experiment, options);
  }
  result["good"] = good;
  write_result(folder / "result.json", result, options.seed);
  fmt::print("{}\n", json_text(result));
  return good ? 0 : 1;
}

}  // namespace

void add_remote_machining_command(Program& program) {
  program.add(
      "remote-machining",
      "Thesis 8.3: two contours cut by hand from afar; result.json, figures 8.6 to 8.8; exit code 1 if "
      "anything "
      "is burnt beyond the corridor or without the button",
      Options{},
      [](Options& o, Settings& s) {
        s.add("netem", o.netem, kProfile, "network profiles, one after the other: shipped names or files");
        s.add("all_profiles", o.all_profiles,
              "runs on every shipped profile as well: figures of their speeds and depths");
        s.add("duration_s", o.duration_s, {.min = 5, .max = 120, .unit = "s"}, "length of a run");
        s.add("laser_w", o.laser_w, {.min = 0.1, .max = 20, .unit = "W"}, "power of the beam");
        s.add("seed", o.seed, kSeeds, "of everything random");
        o.add_quick(s);
        s.add("out", o.out, kFolder, "folder for the results");
      },
      run);
}

}  // namespace telekerf::experiments
