// SPDX-License-Identifier: Apache-2.0
// Rows that a killed process cannot have written: what a damaged disk, a hole in a file or a lost piece of
// memory shows in their place.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/recording/series.h"

namespace telekerf {

/// Of one series, its rows in order, in as many pieces as come. A row cannot be if all of it is zero (a piece
/// that was never written), its tick or time is no number, it does not come after the last good one, or, in a
/// series that has a row each tick, ticks are missing before it and the next row does not go on from it. The
/// row before one that was never written may be half of itself and goes too.
class RowJudge {
 public:
  explicit RowJudge(const SeriesSchema& schema);
  /// Takes the rows out of `numbers` that cannot be; returns how many.
  std::uint64_t keep_possible(std::vector<double>& numbers);
  /// Of the last row that was kept; none: there is no such row or no such column.
  std::optional<double> last_tick() const noexcept { return last_tick_; }

 private:
  bool possible(const double* row, const double* next) const;
  bool never_written(const double* row) const;

  std::size_t width_;
  bool every_tick_;
  std::optional<std::size_t> tick_, time_;
  std::optional<double> last_tick_, last_time_;
};

}  // namespace telekerf
