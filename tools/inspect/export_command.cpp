// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect export RUN WHAT: one thing of a run, to standard output or into a file. Changes nothing of
// the run.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/recording/run_folder.h"
#include "common/recording/run_probe.h"
#include "common/recording/run_reader.h"
#include "common/reporting/run_playback.h"
#include "common/reporting/run_report.h"
#include "common/runtime/enum_table.h"
#include "common/runtime/results.h"
#include "common/runtime/startup_error.h"
#include "tools/inspect/commands.h"

namespace telekerf::inspect {
namespace {

namespace fs = std::filesystem;

enum class RunPart {
  kPlayback,
  kReport,
  kPicture,
  kMaster,
  kSlave,
  kContour,
  kMasterFile,
  kSlaveFile,
  kVisionFile,
  kMachineFile,
  kConsoleFile
};
constexpr EnumRow<RunPart> kRunParts[] = {
    {"playback", RunPart::kPlayback, "what the console's page plays"},
    {"report.json", RunPart::kReport, "the run's report"},
    {"cut.png", RunPart::kPicture, "the picture of the cut that its report has left"},
    {"master.csv", RunPart::kMaster, "the master's rows"},
    {"slave.csv", RunPart::kSlave, "the slave's rows"},
    {"contour.csv", RunPart::kContour, "the contour's points"},
    {"master.h5", RunPart::kMasterFile, "the master's recording"},
    {"slave.h5", RunPart::kSlaveFile, "the slave's recording"},
    {"vision.h5", RunPart::kVisionFile, "vision's recording"},
    {"machine.h5", RunPart::kMachineFile, "automatic machining's recording"},
    {"console.h5", RunPart::kConsoleFile, "the console's recording"}};

struct ExportOptions {
  std::string run;
  RunPart what = RunPart::kPlayback;
  std::string out;
};

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (!in) throw input_error(fmt::format("{}: cannot be read", file.string()));
  return bytes;
}

reporting::PlaybackHead head_of(const fs::path& folder, const fs::path& run) {
  reporting::PlaybackHead head{.name = folder.filename().string(), .created = "", .state = ""};
  for (const char* file : {"master.h5", "slave.h5"}) {
    if (!fs::exists(run / file)) continue;
    const RunReader reader(run / file, RunReader::Check::kHead);
    if (head.created.empty()) head.created = reader.identity().created_utc;
    if (head.state.empty() || reader.state() == RunState::kRecording) head.state = word_of(reader.state());
  }
  return head;
}

std::string made(const ExportOptions& o, const fs::path& run, const std::string& file) {
  const RunRecord record = read_run_so_far(run);
  switch (o.what) {
    case RunPart::kPlayback:
      return reporting::playback_of(record, head_of(o.run, run));
    case RunPart::kReport:
      return json_text(reporting::make_report(record)) + "\n";
    case RunPart::kMaster:
      return csv_of(master_columns(), std::span<const MasterRow>(record.master));
    case RunPart::kSlave:
      return csv_of(slave_columns(), std::span<const SlaveRow>(record.slave));
    case RunPart::kContour:
      return csv_of(contour_columns(), std::span<const Vec2>(record.contour_m));
    case RunPart::kPicture:
    case RunPart::kMasterFile:
    case RunPart::kSlaveFile:
    case RunPart::kVisionFile:
    case RunPart::kMachineFile:
    case RunPart::kConsoleFile:
      break;
  }
  throw input_error(
      fmt::format("{}: holds no {}; what is there, `telekerf-inspect runs` lists", o.run, file));
}

int export_one(const ExportOptions& o) {
  refuse_to_replace_recording("--out", o.out);
  const std::string file(EnumTable<RunPart>(kRunParts).word(o.what));
  const fs::path run = place_of_run(o.run);
  if (std::none_of(std::begin(kRecordedRoles), std::end(kRecordedRoles),
                   [&](const std::string& role) { return fs::exists(run / (role + ".h5")); }))
    throw input_error(fmt::format("{}: holds no recording of a run", o.run));
  probe_recordings(run);
  const std::string bytes =
      o.what != RunPart::kPlayback && fs::exists(run / file) ? bytes_of(run / file) : made(o, run, file);
  if (o.out.empty()) {
    std::fwrite(bytes.data(), 1, bytes.size(), stdout);
  } else {
    write_atomically(o.out, bytes);
  }
  return 0;
}

}  // namespace

void add_export_command(Program& program) {
  program.add(
      "export", "Gives one thing of a run: export FOLDER master.csv; the run stays as it is", ExportOptions{},
      [](ExportOptions& o, Settings& s) {
        s.add("run", o.run, kFolder, "that the run recorded into").as_argument();
        s.add("what", o.what, EnumTable<RunPart>(kRunParts), "of it").as_argument();
        s.add("out", o.out, kFile, "where it goes; not said: standard output").empty_is_said();
      },
      export_one);
}

}  // namespace telekerf::inspect
