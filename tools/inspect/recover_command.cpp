// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect recover FILE: finishes the recording that a killed process has left, and says what it kept.
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "common/recording/run_folder.h"
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
                         series.name, fmt::format("{} rows; {} gaps ({} ticks), {} jumps, {} values that are no numbers",
                                                  series.rows, series.gaps, series.missing_ticks, series.jumps,
                                                  series.non_finite)));
  }
  fmt::print("{}{}{}{}", reporting::table_row("contours, events", fmt::format("{}, {}", kept.contours, kept.events)),
             reporting::table_row("from memory", fmt::format("{} rows that were not in the file yet", kept.rows_from_memory)),
             reporting::table_row("lost", fmt::format("{} rows damaged, {} overwritten", kept.damaged_rows,
                                                      kept.overwritten_rows)),
             reporting::table_row("recovered", file.string()));
}

/// 0: nothing is lost; 1: something is, or nothing is there and nobody knows whether something was.
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
  if (nothing)
    fmt::print("{}", reporting::table_row("verdict", kept->memory ? "it was killed before its first step"
                                                                  : "bad: no row was there to keep"));
  return (nothing && !kept->memory) || kept->damaged_rows + kept->overwritten_rows > 0 ? 1 : 0;
}

/// HDF5 has been seen to hang or to crash on damaged files, so a child reads them, with a time limit.
int recover_in_child(const fs::path& file) {
  std::error_code ignored;
  const auto bytes = fs::file_size(file, ignored);
  const auto limit = std::chrono::seconds(20 + (ignored ? 0 : bytes >> 21U));  // at 2 MB/s
  std::fflush(stdout);
  const pid_t child = ::fork();
  if (child < 0) throw environment_error("recover: no process can be started");
  if (child == 0) {
    int code = 2;
    try {
      code = recover(file);
    } catch (const std::exception& error) {
      fmt::print(stderr, "telekerf-inspect: {}\n", error.what());
    }
    std::fflush(stdout);
    ::_exit(code);
  }
  int status = 0;
  const auto end = std::chrono::steady_clock::now() + limit;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      throw input_error(fmt::format("{}: is damaged so that reading it does not end; it is as it was", file.string()));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (!WIFEXITED(status))
    throw input_error(fmt::format("{}: is damaged so that reading it fails (signal {}); it is as it was",
                                  file.string(), WTERMSIG(status)));
  return WEXITSTATUS(status);
}

}  // namespace

void add_recover_command(Program& program) {
  program.add(
      "recover", "Finishes the recording of a process that was killed; exit 1: not all of it could be kept",
      std::string(),
      [](std::string& file, Settings& s) {
        s.add("file", file, kFile, "recording that a process has left: DIR/master.h5, DIR/slave.h5").as_argument();
      },
      [](const std::string& file) { return recover_in_child(file); });
}

}  // namespace telekerf::inspect
