// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_closing.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "common/recording/flight.h"
#include "common/recording/row_judge.h"
#include "common/recording/row_ring.h"
#include "common/recording/run_reader.h"

namespace telekerf {
namespace {

constexpr std::uint64_t kRowsOfAPiece = 4096;
constexpr std::uint64_t kRowsOfAChunk = 256;  // of an unfinished file: what is damaged alone

/// Rows [first, first + rows) to `take`, as much of them as can be read. Returns the number of rows that
/// cannot.
template <typename Take>
std::uint64_t read_piece(const RunReader& from, std::size_t series, std::uint64_t first, std::uint64_t rows,
                         const Take& take) {
  std::vector<double> numbers;
  if (from.read(series, first, rows, numbers)) {
    take(numbers);
    return 0;
  }
  if (rows <= kRowsOfAChunk) return rows;
  std::uint64_t damaged = 0;
  for (std::uint64_t done = 0; done < rows; done += kRowsOfAChunk)
    damaged += read_piece(from, series, first + done, std::min(kRowsOfAChunk, rows - done), take);
  return damaged;
}

/// Time of the newest row of all, s; 0: there is none.
double newest_s(std::span<const SeriesData> all) {
  double newest = 0.0;
  for (const SeriesData& data : all) {
    const auto& columns = data.schema.columns;
    const auto time = std::find_if(columns.begin(), columns.end(), [](const SeriesColumn& c) { return c.name == "t_s"; });
    if (time != columns.end() && data.rows() > 0)
      newest = std::max(newest, data.row(data.rows() - 1)[time - columns.begin()]);
  }
  return newest;
}

/// What can be read of rows [0, rows), in pieces. Returns the number of rows that cannot.
template <typename Take>
std::uint64_t read_pieces(const RunReader& from, std::size_t series, std::uint64_t rows, const Take& take) {
  std::uint64_t damaged = 0;
  for (std::uint64_t first = 0; first < rows; first += kRowsOfAPiece)
    damaged += read_piece(from, series, first, std::min(kRowsOfAPiece, rows - first), take);
  return damaged;
}

/// Whether the memory goes on from the file: its first row comes next, and its newest is not older than the
/// file's. Otherwise its head is damaged, and the file alone is believed.
bool goes_on(const RowRing::Left& left, const RunReader& from, std::size_t index) {
  const RunReader::Series& series = from.series()[index];
  const auto& columns = series.schema.columns;
  const auto tick =
      std::find_if(columns.begin(), columns.end(), [](const SeriesColumn& c) { return c.name == "tick"; });
  if (left.elsewhere > series.rows) return false;
  if (!series.schema.every_tick || tick == columns.end()) return true;
  const auto at = static_cast<std::size_t>(tick - columns.begin());
  const std::uint64_t capacity_rows = left.last.size() / columns.size();
  if (left.elsewhere == 0) return left.overwritten <= (std::uint64_t{1} << 40U);
  std::vector<double> row;
  if (!from.read(index, left.elsewhere - 1, 1, row)) return true;
  if (capacity_rows > 0 && left.last[(capacity_rows - 1) * columns.size() + at] < row[at]) return false;
  return left.overwritten > 0 || left.numbers.empty() || left.numbers[at] > row[at];
}

}  // namespace

std::uint64_t RunKept::rows() const {
  std::uint64_t sum = 0;
  for (const SeriesAudit& audit : series) sum += audit.rows;
  return sum;
}

std::uint64_t RunKept::missing_ticks() const {
  std::uint64_t sum = 0;
  for (const SeriesAudit& audit : series) sum += audit.missing_ticks;
  return sum;
}

RunKept finish_run_file(const std::filesystem::path& file, const RunEnd& end) {
  RunKept kept;
  const RunReader from(file);
  kept.missing_series = from.missing();
  RunIdentity identity = from.identity();
  for (const auto& [name, figure] : end.figures) identity.figures[name] = figure;
  for (const auto& [name, word] : end.words) identity.words[name] = word;
  ClosedFile to(file, identity, end.state);
  std::vector<std::filesystem::path> rings;
  std::vector<SeriesData> last;
  std::size_t without_memory = 0;
  for (std::size_t n = 0; n < from.series().size(); ++n) {
    const RunReader::Series& series = from.series()[n];
    const std::size_t there = to.add(series.schema);
    std::optional<RowRing::Left> left;
    if (end.state == RunState::kRecovered && !series.ring.empty()) {
      left = RowRing::read(series.ring, series.schema.width());
      if (left && !goes_on(*left, from, n)) left.reset();
      rings.push_back(series.ring);
    }
    if (!left) ++without_memory;
    RowJudge judge(series.schema);
    const auto take = [&](std::vector<double> numbers) {
      if (end.state == RunState::kRecovered) kept.damaged_rows += judge.keep_possible(numbers);
      to.append(there, numbers);
    };
    // Rows behind the acknowledged ones may be there or not; the memory has all of them.
    const std::uint64_t rows = left ? std::min(series.rows, left->elsewhere) : series.rows;
    kept.damaged_rows += read_pieces(from, n, rows, take);
    // By name: a file lists its groups in the alphabet's order, whatever order they were made in.
    const auto never = end.dropped.find(series.schema.name);
    std::uint64_t dropped = series.dropped_rows + (never != end.dropped.end() ? never->second : 0);
    if (left) {
      take(left->numbers);
      kept.rows_from_memory += left->numbers.size() / series.schema.width();
      kept.overwritten_rows += left->overwritten;
      dropped += left->overwritten;
      last.push_back({series.schema, std::move(left->last)});
    }
    to.set_dropped(there, dropped);
  }
  for (const RunEvent& event : from.events(&kept.damaged_rows)) {
    to.append(event);
    ++kept.events;
  }
  for (const RunContour& contour : from.contours(&kept.damaged_rows)) {
    to.append(contour);
    ++kept.contours;
  }
  // At an orderly end that is left to who recovers it, with the memory of the last seconds.
  if (end.state != RunState::kRecovered && !kept.missing_series.empty())
    throw h5::Failure(fmt::format("its data set {} is missing", kept.missing_series.front()));
  if (end.state != RunState::kRecovered && kept.damaged_rows > 0)
    throw h5::Failure(fmt::format("{} of its rows, events and contours are damaged", kept.damaged_rows));
  kept.memory = without_memory == 0;
  if (!last.empty())
    write_flight(file.parent_path() / ("flight-" + identity.role + "-killed.h5"), identity, last,
                 {.t_s = newest_s(last), .kind = "fault", .text = "the process was killed"});
  kept.series = to.finish();
  for (const std::filesystem::path& ring : rings) {
    std::error_code ignored;
    std::filesystem::remove(ring, ignored);
  }
  return kept;
}

}  // namespace telekerf
