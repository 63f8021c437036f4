// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect recover PLACE: finishes the recordings that killed processes have left, and says what it kept.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/recording/run_folder.h"
#include "common/recording/run_probe.h"
#include "common/recording/run_reader.h"
#include "common/reporting/tables.h"
#include "common/runtime/startup_error.h"
#include "tools/inspect/commands.h"

namespace telekerf::inspect {
namespace {

namespace fs = std::filesystem;

void print_kept(const fs::path& file, const RunKept& kept) {
  for (const SeriesAudit& series : kept.series) {
    fmt::print("{}", reporting::table_row(
                         series.name,
                         fmt::format("{} rows; {} gaps ({} ticks), {} jumps, {} values that are no numbers",
                                     series.rows, series.gaps, series.missing_ticks, series.jumps,
                                     series.non_finite)));
  }
  for (const std::string& name : kept.missing_series)
    fmt::print("{}", reporting::table_row(name, "nothing of it can be read any more"));
  fmt::print(
      "{}{}{}{}", reporting::table_row("contours, events", fmt::format("{}, {}", kept.contours, kept.events)),
      reporting::table_row("from memory",
                           fmt::format("{} rows that were not in the file yet", kept.rows_from_memory)),
      reporting::table_row(
          "lost", fmt::format("{} rows damaged, {} overwritten", kept.damaged_rows, kept.overwritten_rows)),
      reporting::table_row("recovered", file.string()));
}

/// 0: nothing is lost; 1: something is, or nobody knows whether something is.
int recover(const fs::path& file) {
  const auto kept = recover_run_file(file);
  if (!kept) {
    const RunReader whole(file);
    for (const auto& series : whole.series())
      fmt::print("{}", reporting::table_row(series.schema.name, fmt::format("{} rows", series.rows)));
    fmt::print("{}", reporting::table_row("whole", fmt::format("{}: {} already; nothing to do", file.string(),
                                                               word_of(whole.state()))));
    return 0;
  }
  print_kept(file, *kept);
  const bool nothing = kept->rows() == 0;
  const bool spoiled = kept->damaged_rows + kept->overwritten_rows > 0 || !kept->missing_series.empty();
  const bool missing = kept->missing_ticks() > 0;
  const char* const verdict =
      nothing && kept->memory && !spoiled ? "it was killed before its first step"
      : nothing                           ? "bad: no row was there to keep"
      : !kept->memory
          ? "bad: up to 100 ms before the end may be missing, since the memory of its process is gone"
      : spoiled ? "bad: not all of it could be kept"
      : missing ? "bad: rows are missing that its process never wrote out"
                : "";
  if (*verdict != 0) fmt::print("{}", reporting::table_row("verdict", verdict));
  return kept->whole() ? 0 : 1;
}

int recover_in_child(const fs::path& file) {
  return in_child(file, [&] {
    try {
      return recover(file);
    } catch (const DamagedRecording& error) {
      fmt::print("{}", reporting::table_row("verdict", fmt::format("bad: {}", error.what())));
      return 1;
    } catch (const std::exception& error) {
      fmt::print(stderr, "telekerf-inspect: {}\n", error.what());
      return 2;
    }
  });
}

/// Of a folder: each recording in it; the worst of their exit codes.
int recover_all(const fs::path& place) {
  std::error_code ignored;
  if (!fs::is_directory(place, ignored)) return recover_in_child(place);
  int worst = -1;
  for (const char* role : kRecordedRoles) {
    const fs::path file = place / fmt::format("{}.h5", role);
    if (fs::exists(file, ignored)) worst = std::max(worst, recover_in_child(file));
  }
  if (worst < 0)
    throw input_error(fmt::format("{}: holds no recording of a run; `telekerf-inspect runs` lists what there is", place.string()));
  return worst;
}

}  // namespace

void add_recover_command(Program& program) {
  program.add(
      "recover", "Finishes the recording of a process that was killed; exit 1: not all of it could be kept",
      std::string(),
      [](std::string& place, Settings& s) {
        s.add("place", place, TextForm{"FILE|FOLDER"},
              "recording that a process has left (DIR/master.h5), or the folder of a run: all that are in it")
            .as_argument();
      },
      [](const std::string& place) { return recover_all(place); });
}

}  // namespace telekerf::inspect
