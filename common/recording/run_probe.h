// SPDX-License-Identifier: Apache-2.0
// HDF5 has been seen to hang and to crash on damaged files, so a child process reads them first.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace telekerf {

/// 20 s, and the time that reading `file` takes at 2 MB/s.
std::chrono::seconds patience_with(const std::filesystem::path& file);

/// Runs `work` in a child process and returns its exit code. Throws StartupError that names `file`: the child
/// did not end within `limit`, or was ended by a signal.
int in_child(const std::filesystem::path& file, const std::function<int()>& work, std::chrono::seconds limit);
inline int in_child(const std::filesystem::path& file, const std::function<int()>& work) {
  return in_child(file, work, patience_with(file));
}

/// What `work` returns in a child process, at most kMostTold bytes of it. Throws StartupError as in_child(),
/// and with the sentence of an exception that `work` threw there.
inline constexpr std::size_t kMostTold = 32'768;  // fits into a pipe that nobody empties meanwhile
std::string told_by_child(const std::filesystem::path& file, const std::function<std::string()>& work,
                          std::chrono::seconds limit);

/// All recordings of the folders (ROLE.h5) are opened and read in a child, a finished one once, for its
/// checksum: what is read of them afterwards needs no check (RunReader::Check::kHead). Throws StartupError
/// that names the file: it cannot be read, is damaged, or reading it crashes or does not end.
void probe_recordings(std::span<const std::filesystem::path> folders);
inline void probe_recordings(const std::filesystem::path& folder) { probe_recordings(std::span(&folder, 1)); }
/// One of them.
void probe_recording(const std::filesystem::path& file);

}  // namespace telekerf
