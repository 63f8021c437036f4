// SPDX-License-Identifier: Apache-2.0
// HDF5 has been seen to hang and to crash on damaged files, so a child process reads them first.
#pragma once

#include <filesystem>
#include <functional>
#include <span>

namespace telekerf {

/// Runs `work` in a child process and returns its exit code. The child has 20 s and the time that `file`
/// takes at 2 MB/s. Throws StartupError that names `file`: the child did not end, or was ended by a signal.
int in_child(const std::filesystem::path& file, const std::function<int()>& work);

/// All recordings of the folders (ROLE.h5) are opened and read in a child. Throws StartupError that names the
/// file: it cannot be read, or reading it crashes or does not end.
void probe_recordings(std::span<const std::filesystem::path> folders);
inline void probe_recordings(const std::filesystem::path& folder) { probe_recordings(std::span(&folder, 1)); }
/// One of them.
void probe_recording(const std::filesystem::path& file);

}  // namespace telekerf
