// SPDX-License-Identifier: Apache-2.0
#include "experiments/replay/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <sstream>
#include <utility>

#include "common/recording/run_folder.h"
#include "common/recording/run_match.h"
#include "common/recording/run_probe.h"
#include "common/recording/run_reader.h"
#include "common/recording/run_tables.h"
#include "common/runtime/startup_error.h"
#include "experiments/replay/what_if.h"

namespace telekerf::experiments {
namespace {

namespace fs = std::filesystem;

/// Of a process' settings those that a run in virtual time has too, by the names that it has them by.
std::string lap_settings(const std::string& toml, const std::string& prefix,
                         const std::vector<Setting>& known) {
  std::istringstream lines(toml);
  std::string out;
  for (std::string line; std::getline(lines, line);) {
    const auto equals = line.find(" = ");
    if (line.starts_with("#") || equals == std::string::npos) continue;
    std::string name = line.substr(0, equals);
    if (name == "robot") {
      name = (prefix.empty() ? "master_" : prefix) + name;
    } else {
      name = prefix + name;
    }
    if (name == "netem" || name == "duration_s") continue;
    if (std::any_of(known.begin(), known.end(), [&](const Setting& s) { return s.name == name; }))
      out += name + line.substr(equals) + "\n";
  }
  return out;
}

std::vector<Setting> known_settings() {
  LapOptions options;
  Settings settings;
  options.add_parameters(settings);
  return settings.declared();
}

/// The slave's clock against the master's, s; zero where nobody has estimated it.
double clock_offset_s(const RunReader& master) {
  const auto found = master.identity().figures.find("clock_offset_us");
  return found == master.identity().figures.end() ? 0.0 : 1e-6 * found->second;
}

void read_operator(const RunReader& master, double period_s, RecordedRun& run) {
  const auto data = master.data("operator");
  if (!data) return;
  for (const OperatorRow& row : rows_of(*data, operator_columns())) {
    const double at_s = static_cast<double>(row.tick) * period_s;
    if (row.stop) {
      run.stops.push_back({at_s, {.number = static_cast<std::uint32_t>(row.value)}});
    } else {
      run.events.push_back({at_s, {row.asker, static_cast<EventMessage::Kind>(row.kind), row.value, ""}});
    }
  }
}

std::vector<BlockRow> blocks_of(const RunReader& site) {
  const auto data = site.data("blocks");
  return data ? rows_of(*data, block_columns()) : std::vector<BlockRow>{};
}

/// Each block fares as the recorded one did; with nothing recorded: a network without delay.
netem::Profile recorded_network(const RecordedRun& run, const simulation::SimulationSettings& lap) {
  netem::Profile network = netem::simple_profile(0.0, 0.0, 0.0);
  const auto replayed = [](const std::vector<RecordedBlock>& blocks, double start_s, double control_hz) {
    netem::DirectionProfile direction;
    netem::Recording recording = trace_of(blocks, start_s, 1.0 / control_hz);
    if (recording.empty()) return direction;
    direction.recording = std::make_shared<const netem::Recording>(std::move(recording));
    direction.trace_end = netem::TraceEnd::kRepeat;
    return direction;
  };
  network.forward = replayed(run.commands, std::max(0.0, -run.slave_starts_s), lap.master.node.control_hz);
  network.backward = replayed(run.states, std::max(0.0, run.slave_starts_s), lap.slave.node.control_hz);
  return network;
}

fs::path required(const char* role, std::span<const fs::path> folders) {
  const auto file = recording_of(role, folders);
  if (!file)
    throw input_error(fmt::format(
        "{}: holds no {}.h5; is this the folder of a run, or must the other site's be named as well?",
        folders.front().string(), role));
  return *file;
}

}  // namespace

RecordedRun read_recorded(std::span<const fs::path> folders) {
  RecordedRun run;
  refuse_idle_folders(folders);
  probe_recordings(folders);
  const fs::path master_file = required("master", folders);
  const fs::path slave_file = required("slave", folders);
  run.record = read_run(folders);
  const RunReader master(master_file, RunReader::Check::kHead);
  const RunReader slave(slave_file, RunReader::Check::kHead);
  refuse_unrelated(master, slave);
  if (run.record.master.empty() || run.record.slave.empty())
    throw input_error(fmt::format("{}: the run has no rows to play", folders.front().string()));
  run.virtual_time = master.identity().virtual_time;
  run.network = master.identity().network;
  const auto name = run.record.words.find("netem");
  run.network_name = name == run.record.words.end() ? "recorded" : name->second;
  const auto contours = master.contours();
  const auto began = master.data("in_force");
  if (contours.empty() || !began || began->rows() == 0)
    throw input_error(fmt::format("{}: no contour was in force: nothing to play", master_file.string()));
  const auto in_force = rows_of(*began, in_force_columns());
  const auto first = std::find_if(contours.begin(), contours.end(),
                                  [&](const RunContour& c) { return c.id == in_force.front().contour_id; });
  const RunContour& contour = first == contours.end() ? contours.front() : *first;
  run.contour = {.id = contour.id,
                 .closed = contour.closed,
                 .source = contour.source,
                 .mode = contour.mode,
                 .metres_per_pixel = contour.metres_per_pixel,
                 .deviation_m = contour.deviation_m,
                 .points_m = contour.points_m,
                 .further = {}};
  if (run.virtual_time) {
    run.settings = master.identity().settings;
    return run;
  }
  const std::vector<Setting> known = known_settings();
  run.settings = lap_settings(master.identity().settings, "", known) +
                 lap_settings(slave.identity().settings, "slave_", known);
  const std::uint64_t tick = run.record.master.front().tick;
  run.contour_from_tick = in_force.front().tick - std::min(in_force.front().tick, tick);
  const double later_s = clock_offset_s(master);
  run.slave_starts_s = run.record.slave.front().t_s - later_s - run.record.master.front().t_s;
  const std::vector<BlockRow> of_master = blocks_of(master), of_slave = blocks_of(slave);
  run.commands = recorded_blocks(of_master, of_slave, tick, later_s);
  run.states = recorded_blocks(of_slave, of_master, run.record.slave.front().tick, -later_s);
  const double rows = static_cast<double>(run.record.master.size() - 1);
  const double rate_hz =
      master.identity().figures.contains("rate_hz") ? master.identity().figures.at("rate_hz") : 1000.0;
  read_operator(
      master,
      rows > 0 ? (run.record.master.back().t_s - run.record.master.front().t_s) / rows : 1.0 / rate_hz, run);
  run.settings +=
      fmt::format("duration_s = {:.3f}\n",
                  std::clamp(run.record.master.back().t_s - run.record.master.front().t_s, 1.0, 600.0));
  return run;
}

RunRecord replay(const RecordedRun& run, const std::string& given) {
  LapOptions options;
  Settings settings;
  options.add_parameters(settings);
  bool record = false;
  std::string out;
  bool quick = false;
  settings.add("record", record, "of the lap");
  settings.add("quick", quick, "of the lap, whose other settings say what it came to");
  settings.add("out", out, kFolder, "of the lap");
  const ConfigFile wanted(given, "command line");
  const ConfigFile recorded(run.settings, "the recorded settings");
  refuse_recorded(settings.declared(), recorded, wanted);
  settings.load(recorded);
  const double rows_s = static_cast<double>(run.record.master.size()) / options.lap.master.node.control_hz;
  const double recorded_s = std::max(options.lap.duration_s, rows_s);
  settings.load(wanted);
  refuse_beyond_end(options.lap.duration_s, recorded_s);
  settings.refuse_without_effect();
  const std::string own = options.netem;
  if (!wanted.has("netem")) options.netem = "ideal";  // the recorded one follows
  simulation::SimulationSettings lap = options.prepared();
  if (!wanted.has("netem")) {
    const std::string folder = fs::path(own).parent_path().string();
    lap.network = run.virtual_time ? netem::parse_profile(run.network, run.network_name, folder)
                                   : recorded_network(run, lap);
    lap.network.name = run.network_name;
  }
  lap.hand = run.record.master;
  lap.events = run.events;
  lap.stops = run.stops;
  lap.contour_from_tick = run.contour_from_tick;
  lap.slave_starts_s = run.slave_starts_s;
  if (!run.virtual_time)
    lap.master.engage = run.settings.find("\nengage = true") != std::string::npos || run.events.empty();
  return simulation::simulate(lap, run.contour);
}

}  // namespace telekerf::experiments
