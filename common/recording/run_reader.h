// SPDX-License-Identifier: Apache-2.0
// Reads the file of a run, whether it was finished, is being written, or was left by a killed process.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/recording/run_file.h"

namespace telekerf {

class RunReader {
 public:
  /// Throws StartupError that names the file: it is no recording, or none of this format.
  explicit RunReader(const std::filesystem::path& file);
  ~RunReader();
  RunReader(const RunReader&) = delete;
  RunReader& operator=(const RunReader&) = delete;

  RunState state() const noexcept { return state_; }
  const RunIdentity& identity() const noexcept { return identity_; }
  /// The process that still writes it, on this computer.
  std::optional<int> writer() const noexcept { return writer_; }

  struct Series {
    SeriesSchema schema;
    std::uint64_t rows = 0;
    std::filesystem::path ring;      ///< of an unfinished file
    std::uint64_t dropped_rows = 0;  ///< of a finished one
  };
  const std::vector<Series>& series() const noexcept { return series_; }
  /// Rows `first` .. of a series appended to `out`; false: they are damaged, and `out` is as before.
  bool read(std::size_t series, std::uint64_t first, std::uint64_t rows, std::vector<double>& out) const;
  /// All of it; damaged rows are left out. None: the file has no such series.
  std::optional<SeriesData> data(const std::string& name) const;
  std::vector<RunEvent> events() const;
  std::vector<RunContour> contours() const;

 private:
  h5::Id file_;
  RunState state_ = RunState::kRecording;
  RunIdentity identity_;
  std::optional<int> writer_;
  std::vector<Series> series_;
};

}  // namespace telekerf
