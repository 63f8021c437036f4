// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect run FOLDER: the report of a finished run from what its processes recorded.
#include <fmt/format.h>

#include <filesystem>
#include <vector>

#include "common/recording/run_folder.h"
#include "common/recording/run_match.h"
#include "common/recording/run_probe.h"
#include "common/reporting/run_report.h"
#include "common/reporting/tables.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "tools/inspect/commands.h"
#include "tools/inspect/run_mcap.h"

namespace telekerf::inspect {
namespace {

namespace fs = std::filesystem;

struct RunOptions {
  std::string folder;
  std::string other;
  std::string out;
  std::string mcap;
  bool csv = false;
};

std::string label_row(std::span<const fs::path> folders) {
  const auto file = recording_of("master", folders);
  const auto label = file ? label_of(*file) : std::nullopt;
  if (!label) return {};
  return reporting::table_row("label", fmt::format("{}: {}", label->good ? "good" : "bad", label->text));
}

void refuse_mcap_place(const fs::path& file, const fs::path& out) {
  refuse_to_replace_recording("--mcap", file);
  std::error_code ignored;
  for (const char* result : {"report.json", "trace.csv", "cut.png", "master.csv", "slave.csv", "contour.csv"}) {
    if (fs::weakly_canonical(file, ignored) == fs::weakly_canonical(out / result, ignored))
      throw usage_error(fmt::format("--mcap {}: is where another result goes; name another file", file.string()));
  }
}

int report_run(const RunOptions& options) {
  std::vector<fs::path> folders = {options.folder};
  if (!options.other.empty()) folders.emplace_back(options.other);
  const std::string out = options.out.empty() ? options.folder : options.out;
  if (!options.mcap.empty()) refuse_mcap_place(options.mcap, out);
  refuse_idle_folders(folders);
  probe_recordings(folders);
  refuse_unrelated(folders);
  if (!options.mcap.empty() && recording_of("machine", folders) && !recording_of("master", folders)) {
    // Machined without a hand: its report is result.json, which the machine itself writes.
    write_mcap(options.mcap, folders);
    fmt::print("{}", reporting::table_row("files", options.mcap));
    return 0;
  }
  const RunRecord record = read_run(folders);
  if (!options.out.empty()) make_folder("--out", out);
  if (options.csv) {
    write_contour(out, record);
    write_master(out, record);
    write_slave(out, record);
  }
  if (!options.mcap.empty()) write_mcap(options.mcap, folders);
  const auto report = reporting::write_report(out, record);
  const std::string verdict = !reporting::stayed_inside(report) ? "bad: the laser left the corridor"
                              : reporting::succeeded(report)    ? ""
                                                                : "bad: nothing was cut";
  fmt::print("{}{}{}{}", reporting::run_table(report),
             reporting::table_row("files", fmt::format("{0}/report.json, {0}/cut.png, {0}/trace.csv", out)),
             label_row(folders), verdict.empty() ? "" : reporting::table_row("verdict", verdict));
  return verdict.empty() ? 0 : 1;
}

}  // namespace

void add_run_command(Program& program) {
  program.add(
      "run", "Report of a finished run: report.json, trace.csv, cut.png", RunOptions{},
      [](RunOptions& o, Settings& s) {
        s.add("folder", o.folder, kFolder, "that the run recorded into").as_argument();
        s.add("other_folder", o.other, kFolder, "that of the other site, if it is not the same")
            .empty_is_said()
            .positional = true;
        s.add("csv", o.csv, "writes the rows as text as well: master.csv, slave.csv, contour.csv");
        s.add("mcap", o.mcap, TextForm{.form = "FILE", .complaint = [](const std::string&) { return ""; }},
              "writes everything that was recorded into this MCAP file as well")
            .empty_is_said();
        s.add("out", o.out, kFolder, "folder for the results; not said: the run's").empty_is_said();
      },
      report_run);
}

}  // namespace telekerf::inspect
