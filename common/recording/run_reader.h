// SPDX-License-Identifier: Apache-2.0
// Reads the file of a run, whether it was finished, is being written, or was left by a killed process.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/recording/run_file.h"
#include "common/runtime/startup_error.h"

namespace telekerf {

/// A recording that is no longer what was written. The sentence says where.
struct DamagedRecording : StartupError {
  using StartupError::StartupError;
};

class RunReader {
 public:
  /// Of a finished file all that is in it is read and checked; or its head only.
  enum class Check { kAll, kHead };
  /// Throws StartupError that names the file: it is no recording, or none of this format; DamagedRecording:
  /// of a finished one a data set is missing or damaged, or the contents are not those that were written.
  explicit RunReader(const std::filesystem::path& file, Check check = Check::kAll);
  ~RunReader();
  RunReader(const RunReader&) = delete;
  RunReader& operator=(const RunReader&) = delete;

  const std::filesystem::path& file() const noexcept { return path_; }
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
  /// Names of those that an unfinished file was begun with and that cannot be found in it any more.
  const std::vector<std::string>& missing() const noexcept { return missing_; }
  /// Rows `first` .. of a series appended to `out`; false: they are damaged, and `out` is as before.
  bool read(std::size_t series, std::uint64_t first, std::uint64_t rows, std::vector<double>& out) const;
  /// Stamps of its first and last row, s. None: it has no row, no stamps, or these are damaged.
  std::optional<std::pair<double, double>> span_s(std::size_t series) const;
  /// All of it. None: the file has no such series. Damaged rows: of a finished file throws DamagedRecording,
  /// of an unfinished one they are left out. The same for what follows.
  std::optional<SeriesData> data(const std::string& name) const;
  /// `damaged`: of an unfinished file the number of those left out is added; a list that cannot be read is
  /// one.
  std::vector<RunEvent> events(std::uint64_t* damaged = nullptr) const;
  std::vector<RunContour> contours(std::uint64_t* damaged = nullptr) const;

 private:
  void open(Check check);
  void find_missing();
  void add_series(hid_t group, const std::string& name);
  void read_or_throw(std::size_t series, std::uint64_t first, std::uint64_t rows,
                     std::vector<double>& out) const;
  [[noreturn]] void damaged(const std::string& what) const;

  std::filesystem::path path_;
  h5::Id file_;
  RunState state_ = RunState::kRecording;
  RunIdentity identity_;
  std::optional<int> writer_;
  std::vector<Series> series_;
  std::vector<std::string> missing_;
};

}  // namespace telekerf
