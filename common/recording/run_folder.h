// SPDX-License-Identifier: Apache-2.0
// What the processes of a run have left in one folder, or in one a site.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/recording/run_closing.h"
#include "common/recording/run_record.h"

namespace telekerf {

/// Whose recordings a folder may hold: ROLE.h5.
inline constexpr const char* kRecordedRoles[] = {"master", "slave", "vision", "machine", "console"};

/// Where a role's recording lies, as it is: in the first of the folders that has one; none: none has.
std::optional<std::filesystem::path> find_recording(const std::string& role,
                                                    std::span<const std::filesystem::path> folders);

/// The recording of a role in the first of the folders that has one; none: none has. One that a killed
/// process has left is finished first. Throws StartupError: a process is still at it.
std::optional<std::filesystem::path> recording_of(const std::string& role,
                                                  std::span<const std::filesystem::path> folders);

/// Throws StartupError if one of the folders adds nothing: it has no recording (or master.csv, slave.csv) of a role
/// that no folder before it has.
void refuse_idle_folders(std::span<const std::filesystem::path> folders);

/// Throws StartupError if `file`, which `option` names for an output, is the recording of a run.
void refuse_to_replace_recording(const std::string& option, const std::filesystem::path& file);

/// Finishes what a killed process has left. None: it was finished already. Throws StartupError if it is no
/// recording, still being written, or cannot be replaced.
std::optional<RunKept> recover_run_file(const std::filesystem::path& file);

/// The record of the run from its recordings; a part that has none from the text that a process left
/// (read_run). The checksum of finished files is not looked at: probe_recordings() does that. Throws
/// StartupError that names what is missing.
RunRecord read_run(std::span<const std::filesystem::path> folders);
inline RunRecord read_run(const std::filesystem::path& folder) { return read_run(std::span(&folder, 1)); }

/// Where the recordings of a run lie: in its folder, or in the draft below it (.run-*) that ./telekerf keeps
/// until the run has ended. Without recordings: the folder itself.
std::filesystem::path place_of_run(const std::filesystem::path& folder);

/// What is there so far of a run that may still go on: nothing is finished or changed, and what a folder
/// lacks stays empty. Throws StartupError: a recording is none.
RunRecord read_run_so_far(const std::filesystem::path& folder);

/// A person's verdict on a run.
struct RunLabel {
  bool good = true;
  std::string text;
};
/// Attached to every recording of the folder, in place of one before. Throws StartupError.
void label_run(const std::filesystem::path& folder, const RunLabel& label);
std::optional<RunLabel> label_of(const std::filesystem::path& file);

}  // namespace telekerf
