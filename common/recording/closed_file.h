// SPDX-License-Identifier: Apache-2.0
// The finished file of a run: a dataset a quantity, compressed, in the format that every HDF5 since 1.8
// reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/recording/run_file.h"

namespace telekerf {

/// What was looked for while a series was copied.
struct SeriesAudit {
  std::string name;
  std::uint64_t rows = 0;
  std::uint64_t gaps = 0;           ///< places where ticks are missing, also before the first row
  std::uint64_t missing_ticks = 0;  ///< there, together
  std::uint64_t non_finite = 0;     ///< numbers that are none
  std::uint64_t jumps = 0;          ///< a robot's place further from the one a tick before than kJump_m
  static constexpr double kJump_m = 2e-3;
};

/// One thread only. Written beside `file` and put in its place by finish(); before that nothing is there.
class ClosedFile {
 public:
  /// All members throw h5::Failure.
  ClosedFile(std::filesystem::path file, const RunIdentity& identity, RunState state);
  ~ClosedFile();
  ClosedFile(const ClosedFile&) = delete;
  ClosedFile& operator=(const ClosedFile&) = delete;

  /// Where the rows of a series that has one each tick begin: with tick 0, and what is missing before the
  /// first is a gap; or anywhere, as the last seconds do.
  enum class Begin { kAtFirstTick, kAnywhere };
  std::size_t add(const SeriesSchema& schema, Begin begin = Begin::kAtFirstTick);
  void append(std::size_t series, std::span<const double> numbers);
  void append(const RunEvent& event);
  void append(const RunContour& contour);
  /// Rows that never came into the file.
  void set_dropped(std::size_t series, std::uint64_t rows);
  std::vector<SeriesAudit> finish();

 private:
  struct Column {
    h5::Id dataset;
    Quantity quantity;
    ColumnKind kind;
  };
  struct Series {
    SeriesSchema schema;
    h5::Id group;
    Begin begin;
    std::vector<Column> columns;
    std::vector<double> last;
    SeriesAudit audit;
  };
  void look_at(Series& series, std::span<const double> numbers);
  void close();

  std::filesystem::path place_;
  std::filesystem::path draft_;
  h5::Id file_;
  std::vector<Series> series_;
  std::vector<std::byte> events_;    ///< cells, as in run_file.h
  std::vector<std::byte> contours_;  ///< likewise
  h5::Id points_;
  std::uint64_t point_rows_ = 0;
};

}  // namespace telekerf
