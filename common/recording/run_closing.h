// SPDX-License-Identifier: Apache-2.0
// From the file of a run that has ended, in order or not, to the finished one in its place.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/recording/closed_file.h"

namespace telekerf {

/// What is known at the end only.
struct RunEnd {
  RunState state = RunState::kClosed;
  Metrics figures = {};
  Metadata words = {};
  std::map<std::string, std::uint64_t> dropped = {};  ///< rows not in the file, by the series' name
};

/// What became of a file.
struct RunKept {
  std::vector<SeriesAudit> series = {};
  std::uint64_t rows_from_memory = 0;  ///< that the file did not hold yet when its process was killed
  std::uint64_t damaged_rows = 0;      ///< unreadable or impossible (RowJudge); events and contours too
  std::uint64_t overwritten_rows = 0;  ///< that nobody has any more
  std::vector<std::string> missing_series = {};  ///< of which nothing could be read, not even their head
  bool memory = false;  ///< that the process had left was there for every series: what is not kept never was
  std::size_t events = 0;
  std::size_t contours = 0;
  std::uint64_t rows() const;
  std::uint64_t missing_ticks() const;
  /// Nothing is lost, and somebody knows that.
  bool whole() const {
    return memory && missing_series.empty() && damaged_rows + overwritten_rows + missing_ticks() == 0;
  }
};

/// Copies `file` into its finished form and puts that in its place. Of a killed process the rows that it had
/// not written out yet are taken from the memory that it left (RowRing), and the last ten seconds are written
/// into a file beside it as well. Throws StartupError if it is no recording, h5::Failure if the copy cannot
/// be written; `file` is as before then.
RunKept finish_run_file(const std::filesystem::path& file, const RunEnd& end);

}  // namespace telekerf
