// SPDX-License-Identifier: Apache-2.0
// telekerf-experiment replay FOLDER: a recorded run once more in virtual time, as it was or with other
// settings.
#include <fmt/format.h>

#include <filesystem>

#include "common/reporting/run_report.h"
#include "common/reporting/tables.h"
#include "common/runtime/results.h"
#include "experiments/commands.h"
#include "experiments/replay/replay.h"
#include "experiments/replay/rows_difference.h"
#include "experiments/replay/what_if.h"

namespace telekerf::experiments {
namespace {

namespace fs = std::filesystem;

struct Options : LapOptions {
  std::string folder;
  std::string other;
  std::string out;
  std::string given;
};

/// Of what was given, that which belongs to the run itself.
std::string what_if(const std::string& given) {
  std::string out;
  std::size_t at = 0;
  while (at < given.size()) {
    const std::size_t end = std::min(given.find('\n', at), given.size());
    const std::string line = given.substr(at, end - at);
    if (!line.starts_with("#") && !line.starts_with("out = ")) out += line + "\n";
    at = end + 1;
  }
  return out;
}

nlohmann::ordered_json json_of(const RowsDifference& d) {
  return {{"recorded", d.recorded},
          {"replayed", d.replayed},
          {"compared", d.compared},
          {"different", d.different},
          {"first_tick", d.different > 0 ? nlohmann::ordered_json(d.first_tick) : nullptr},
          {"column", d.column},
          {"tool_rms_um", 1e6 * d.tool_rms_m},
          {"tool_max_um", 1e6 * d.tool_max_m}};
}

void print_measure(const char* name, const char* part, const char* field, const nlohmann::ordered_json& was,
                   const nlohmann::ordered_json& is) {
  const auto text = [&](const nlohmann::ordered_json& report) {
    const auto& value = report[part][field];
    return value.is_number() ? fmt::format("{:.3f}", value.get<double>()) : std::string("-");
  };
  fmt::print("{}", reporting::table_row(name, fmt::format("{} recorded, {} replayed", text(was), text(is))));
}

/// 0: the same bit by bit, or a run that cannot be (real, or other settings were asked for); 1: a run in
/// virtual time came out another.
int run(const Options& options) {
  std::vector<fs::path> folders = {options.folder};
  if (!options.other.empty()) folders.emplace_back(options.other);
  if (!options.out.empty()) refuse_taken_folder(options.out, folders);
  const RecordedRun recorded = read_recorded(folders);
  const std::string asked = what_if(options.given);
  const RunRecord again = replay(recorded, asked);
  const auto differences = compare(recorded.record, again, recorded.virtual_time);
  const auto was = reporting::make_report(recorded.record);
  const auto is = reporting::make_report(again);
  bool identical = true;
  nlohmann::ordered_json json;
  for (const RowsDifference& d : differences) {
    identical = identical && d.identical();
    json[d.name] = json_of(d);
    fmt::print(
        "{}",
        reporting::table_row(
            d.name, d.identical()
                        ? fmt::format("{} rows, the same bit by bit", d.recorded)
                    : d.different == 0
                        ? fmt::format("{} rows, the same bit by bit; {} recorded, {} replayed", d.compared, d.recorded,
                                      d.replayed)
                        : fmt::format("{} of {} rows differ, from tick {:.0f} on ({}); tool {:.1f} um rms, "
                                      "{:.1f} um at most; {} rows recorded, {} replayed",
                                      d.different, d.compared, d.first_tick, d.column, 1e6 * d.tool_rms_m,
                                      1e6 * d.tool_max_m, d.recorded, d.replayed)));
  }
  print_measure("tracking rms [um]", "tracking", "rms_um", was, is);
  print_measure("prediction rms [um]", "prediction", "rmse_um", was, is);
  print_measure("cut rms [um]", "cut", "rms_um", was, is);
  print_measure("coverage", "cut", "coverage", was, is);
  print_measure("outside the corridor [J]", "cut", "energy_outside_corridor_j", was, is);
  json["identical"] = identical;
  json["virtual_time"] = recorded.virtual_time;
  json["what_if"] = asked;
  if (!options.out.empty()) {
    make_folder("--out", options.out);
    reporting::write_report(options.out, again);
    write_json(fs::path(options.out) / kReplayFile, json);
  }
  const bool bad = !identical && recorded.virtual_time && asked.empty();
  fmt::print("{}",
             reporting::table_row(
                 "verdict", identical        ? "the same bit by bit"
                            : bad            ? "bad: it should be the same bit by bit"
                            : !asked.empty() ? "another run, as asked"
                                             : "the run was real: this is how far virtual time is off it"));
  return bad ? 1 : 0;
}

}  // namespace

void add_replay_command(Program& program) {
  program.add(
      "replay", "A recorded run once more in virtual time, as it was or with other settings", Options{},
      [](Options& o, Settings& s) {
        s.add("folder", o.folder, kFolder, "that the run recorded into").as_argument();
        s.add("other_folder", o.other, kFolder, "that of the other site, if it is not the same")
            .empty_is_said()
            .positional = true;
        o.add_parameters(s);
        s.add("out", o.out, kFolder, "folder for the report of the replay; not said: none is written")
            .empty_is_said();
      },
      run);
}

}  // namespace telekerf::experiments
