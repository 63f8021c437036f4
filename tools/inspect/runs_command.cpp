// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect runs [FOLDER]: what runs there are, the newest first.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/recording/run_folder.h"
#include "common/recording/run_reader.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "tools/inspect/commands.h"

namespace telekerf::inspect {
namespace {

namespace fs = std::filesystem;

struct RunsOptions {
  std::string folder = "out";
  bool json = false;
};

struct ListedRun {
  std::string name;
  std::string created;            ///< ISO 8601; empty: nobody knows
  std::string state;              ///< closed, recovered, recording, killed, damaged
  double seconds = 0.0;           ///< of its longest recording
  std::vector<std::string> roles;  ///< whose recordings there are
  std::string label;              ///< "good: why"
};

/// Time between the first row of each control step and the last.
double seconds_of(const RunReader& reader) {
  for (std::size_t n = 0; n < reader.series().size(); ++n) {
    const RunReader::Series& series = reader.series()[n];
    const auto& columns = series.schema.columns;
    const auto time =
        std::find_if(columns.begin(), columns.end(), [](const SeriesColumn& c) { return c.name == "t_s"; });
    if (!series.schema.every_tick || series.rows == 0 || time == columns.end()) continue;
    std::vector<double> ends;
    if (!reader.read(n, 0, 1, ends) || !reader.read(n, series.rows - 1, 1, ends)) continue;
    const auto at = static_cast<std::size_t>(time - columns.begin());
    return ends[columns.size() + at] - ends[at];
  }
  return 0.0;
}

void look_at(const fs::path& file, ListedRun& run) {
  try {
    const RunReader reader(file);
    if (run.created.empty()) run.created = reader.identity().created_utc;
    const bool unfinished = reader.state() == RunState::kRecording;
    const std::string state = !unfinished ? word_of(reader.state()) : reader.writer() ? "recording" : "killed";
    if (run.state.empty() || unfinished) run.state = state;
    run.seconds = std::max(run.seconds, seconds_of(reader));
    if (!unfinished && run.label.empty()) {
      if (const auto label = label_of(file))
        run.label = fmt::format("{}{}{}", label->good ? "good" : "bad", label->text.empty() ? "" : ": ", label->text);
    }
  } catch (const std::exception&) {
    run.state = "damaged";
  }
}

std::vector<ListedRun> runs_in(const fs::path& folder) {
  std::error_code error;
  std::vector<ListedRun> runs;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (name.starts_with('.') || !at->is_directory(error)) continue;
    ListedRun run;
    run.name = name;
    const fs::path place = place_of_run(at->path());
    for (const char* role : kRecordedRoles) {
      const fs::path file = place / fmt::format("{}.h5", role);
      if (!fs::exists(file, error)) continue;
      run.roles.emplace_back(role);
      look_at(file, run);
    }
    if (!run.roles.empty()) runs.push_back(std::move(run));
  }
  if (error) throw input_error(fmt::format("{}: cannot be listed: {}", folder.string(), error.message()));
  std::sort(runs.begin(), runs.end(), [](const ListedRun& a, const ListedRun& b) {
    return std::tie(a.created, a.name) > std::tie(b.created, b.name);
  });
  return runs;
}

int list_runs(const RunsOptions& options) {
  const std::vector<ListedRun> runs = runs_in(options.folder);
  if (options.json) {
    auto list = nlohmann::ordered_json::array();
    for (const ListedRun& run : runs) {
      list.push_back({{"name", run.name},
                      {"created", run.created},
                      {"state", run.state},
                      {"seconds", run.seconds},
                      {"roles", run.roles},
                      {"label", run.label}});
    }
    fmt::print("{}\n", json_text(nlohmann::ordered_json{{"folder", options.folder}, {"runs", list}}));
    return 0;
  }
  if (runs.empty()) fmt::print("{}: no recorded run\n", options.folder);
  for (const ListedRun& run : runs) {
    fmt::print("{:<28} {:<20} {:8.1f} s  {:<9} {:<15} {}\n", run.name, run.created, run.seconds, run.state,
               fmt::format("{}", fmt::join(run.roles, ", ")), run.label);
  }
  return 0;
}

}  // namespace

void add_runs_command(Program& program) {
  program.add(
      "runs", "Lists the recorded runs of a folder, the newest first", RunsOptions{},
      [](RunsOptions& o, Settings& s) {
        s.add("folder", o.folder, kFolder, "whose folders are the runs").positional = true;
        s.add("json", o.json, "for machines");
      },
      list_runs);
}

}  // namespace telekerf::inspect
