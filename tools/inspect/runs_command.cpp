// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect runs [FOLDER]: what runs there are, the newest first.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/recording/run_folder.h"
#include "common/recording/run_probe.h"
#include "common/recording/run_reader.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "tools/inspect/commands.h"

namespace telekerf::inspect {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kPatience{5};  // with a head: the console waits for the list
constexpr std::size_t kLongestLabel = 2000;

struct RunsOptions {
  std::string folder = "out";
  bool json = false;
};

struct ListedRun {
  std::string name;
  std::string created;             ///< ISO 8601; empty: nobody knows
  std::string state;               ///< closed, recovered, recording, killed, damaged
  double seconds = 0.0;            ///< of its longest recording
  std::vector<std::string> roles;  ///< whose recordings there are
  std::string label;               ///< "good: why"
  std::string damage;              ///< of the first damaged recording: which and how
};

/// Time between the first row of each control step and the last.
double seconds_of(const RunReader& reader) {
  for (std::size_t n = 0; n < reader.series().size(); ++n) {
    const auto span = reader.series()[n].schema.every_tick ? reader.span_s(n) : std::nullopt;
    if (span) return span->second - span->first;
  }
  return 0.0;
}

/// What the list says of one recording, as JSON; only its head is read.
std::string head_of(const fs::path& file) {
  const RunReader reader(file, RunReader::Check::kHead);
  const bool unfinished = reader.state() == RunState::kRecording;
  nlohmann::ordered_json head{{"created", reader.identity().created_utc},
                              {"unfinished", unfinished},
                              {"state", !unfinished       ? word_of(reader.state())
                                        : reader.writer() ? "recording"
                                                          : "killed"},
                              {"seconds", seconds_of(reader)},
                              {"label", ""}};
  if (const auto label = unfinished ? std::nullopt : label_of(file))
    head["label"] = fmt::format("{}{}{}", label->good ? "good" : "bad", label->text.empty() ? "" : ": ",
                                label->text.substr(0, kLongestLabel));
  return head.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

/// A damaged file is one line of the list, whatever reading it does to the process that reads it.
void look_at(const fs::path& file, ListedRun& run) {
  try {
    const auto head = nlohmann::json::parse(told_by_child(
        file, [&] { return head_of(file); }, kPatience));
    if (run.created.empty()) run.created = head["created"];
    if (run.damage.empty() && (run.state.empty() || head["unfinished"])) run.state = head["state"];
    run.seconds = std::max(run.seconds, head["seconds"].get<double>());
    if (run.label.empty()) run.label = head["label"];
  } catch (const std::exception& error) {
    run.state = "damaged";
    if (run.damage.empty()) run.damage = error.what();
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
                      {"label", run.label},
                      {"damage", run.damage}});
    }
    fmt::print("{}\n", json_text(nlohmann::ordered_json{{"folder", options.folder}, {"runs", list}}));
    return 0;
  }
  if (runs.empty()) fmt::print("{}: no recorded run\n", options.folder);
  for (const ListedRun& run : runs) {
    fmt::print("{:<28} {:<20} {:8.1f} s  {:<9} {:<15} {}\n", run.name, run.created, run.seconds, run.state,
               fmt::format("{}", fmt::join(run.roles, ", ")), run.damage.empty() ? run.label : run.damage);
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
