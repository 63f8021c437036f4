// SPDX-License-Identifier: Apache-2.0
// The file of a run that goes on: everything is made before the run starts, then rows are added and flushed so
// that a process that is killed leaves what it has flushed (HDF5's single writer, multiple readers).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "common/recording/run_file.h"

namespace telekerf {

/// One thread only. Raw and in one piece a series: the finished file (closed_file.h) has a dataset a quantity.
class LiveFile {
 public:
  struct Part {
    SeriesSchema schema;
    std::filesystem::path ring;  ///< where a killed process leaves its newest rows, see RowRing
  };
  /// Throws h5::Failure.
  LiveFile(const std::filesystem::path& file, const RunIdentity& identity, const std::vector<Part>& parts);
  ~LiveFile();
  LiveFile(const LiveFile&) = delete;
  LiveFile& operator=(const LiveFile&) = delete;

  /// All of them throw h5::Failure; after flush() what came before is safe.
  void append(std::size_t part, std::span<const double> numbers);
  void append(const RunEvent& event);
  void append(const RunContour& contour);
  void flush();
  /// Where the file lies now, whoever has moved it; empty: it has been removed. `file`: where it was last.
  std::filesystem::path place(const std::filesystem::path& file) const;
  std::uint64_t rows(std::size_t part) const noexcept { return series_[part].rows; }

 private:
  struct Series {
    h5::Id dataset;
    std::size_t width = 0;
    std::uint64_t rows = 0;
  };
  h5::Id file_;
  std::vector<Series> series_;
  h5::Id events_;
  h5::Id contours_;
  h5::Id points_;
  h5::Id event_type_;
  h5::Id contour_type_;
  std::uint64_t point_rows_ = 0;
};

}  // namespace telekerf
