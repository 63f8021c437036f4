// SPDX-License-Identifier: Apache-2.0
#include "common/recording/process_recording.h"

#include <fmt/format.h>

#include <utility>

#include "common/runtime/startup_error.h"

namespace telekerf {

ProcessRecording::ProcessRecording(const RecordFlags& flags, RunIdentity identity,
                                   const std::vector<Recording::Part>& parts, StatusReporter& status)
    : status_(status), named_(flags.named()) {
  if (flags.off()) return;
  try {
    date_now(identity);
    const std::filesystem::path file = flags.folder(identity.role) / (identity.role + ".h5");
    recording_ = std::make_unique<Recording>(file, identity, parts,
                                             [this](const std::string& said) { status_.say(said); });
  } catch (const StartupError& refusal) {
    if (flags.named()) throw;
    status_.say(fmt::format("this run is not recorded: {}", refusal.what()));
    return;
  }
  if (!flags.named()) status_.say(fmt::format("recorded in {}", recording_->file().string()));
  status_.listen([this](const std::string& said) { recording_->add(RunEvent{0.0, -1, "said", 0.0, said}); });
}

ProcessRecording::~ProcessRecording() { status_.listen({}); }

bool ProcessRecording::close(const RunEnd& end) {
  if (!recording_) return false;
  status_.listen({});
  const auto kept = recording_->close(end);
  unfinished_ = !kept;
  if (!kept) return false;
  for (const SeriesAudit& audit : kept->series) {
    if (audit.gaps + audit.jumps + audit.non_finite == 0) continue;
    status_.say(
        fmt::format("the record of {} has {} gaps ({} ticks), {} jumps, {} values that are no numbers",
                    audit.name, audit.gaps, audit.missing_ticks, audit.jumps, audit.non_finite));
  }
  if (const auto lost = recording_->dropped(); lost > 0)
    status_.say(fmt::format("{} rows are not in the record", lost));
  return true;
}

void ProcessRecording::refuse_unfinished() const {
  if (named_ && unfinished_)
    throw environment_error(
        fmt::format("--record {}: the run has ended, but its record is not finished (why is said above)", file().string()));
}

}  // namespace telekerf
