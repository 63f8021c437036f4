// SPDX-License-Identifier: Apache-2.0
#include "common/recording/row_judge.h"

#include <algorithm>
#include <cmath>

namespace telekerf {
namespace {

std::optional<std::size_t> column_of(const SeriesSchema& schema, const char* name) {
  for (std::size_t n = 0; n < schema.width(); ++n)
    if (schema.columns[n].name == name) return n;
  return std::nullopt;
}

}  // namespace

RowJudge::RowJudge(const SeriesSchema& schema)
    : width_(schema.width()),
      every_tick_(schema.every_tick),
      tick_(column_of(schema, "tick")),
      time_(column_of(schema, "t_s")) {}

bool RowJudge::never_written(const double* row) const {
  return std::all_of(row, row + width_, [](double number) { return number == 0.0 && !std::signbit(number); });
}

bool RowJudge::possible(const double* row, const double* next) const {
  if (never_written(row)) return false;
  if (time_ && !std::isfinite(row[*time_])) return false;
  if (!every_tick_) return true;
  if (time_ && last_time_ && row[*time_] < *last_time_) return false;
  if (!tick_) return true;
  const double tick = row[*tick_];
  if (!(tick >= 0.0) || tick != std::floor(tick)) return false;
  if (!last_tick_ || tick == *last_tick_ + 1.0) return true;
  // Ticks may be missing, where the disk stood still; then the next row goes on from here.
  return tick > *last_tick_ && (next == nullptr || next[*tick_] == tick + 1.0);
}

std::uint64_t RowJudge::keep_possible(std::vector<double>& numbers) {
  const std::size_t rows = numbers.size() / width_;
  std::vector<double> kept;
  kept.reserve(numbers.size());
  for (std::size_t n = 0; n < rows; ++n) {
    const double* row = numbers.data() + n * width_;
    const double* next = n + 1 < rows ? row + width_ : nullptr;
    if (!possible(row, next) || (every_tick_ && next != nullptr && never_written(next))) continue;
    kept.insert(kept.end(), row, row + width_);
    if (tick_) last_tick_ = row[*tick_];
    if (time_) last_time_ = row[*time_];
  }
  const std::uint64_t gone = rows - kept.size() / width_;
  numbers.swap(kept);
  return gone;
}

}  // namespace telekerf
