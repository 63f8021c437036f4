// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_closing.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "common/recording/flight.h"
#include "common/recording/row_ring.h"
#include "common/recording/run_reader.h"

namespace telekerf {
namespace {

constexpr std::uint64_t kRowsOfAPiece = 4096;

/// What can be read of rows [0, rows), in pieces. Returns the number of rows that cannot.
template <typename Take>
std::uint64_t read_pieces(const RunReader& from, std::size_t series, std::uint64_t rows, Take take) {
  std::uint64_t damaged = 0;
  std::vector<double> numbers;
  for (std::uint64_t first = 0; first < rows; first += kRowsOfAPiece) {
    const std::uint64_t count = std::min(kRowsOfAPiece, rows - first);
    numbers.clear();
    if (from.read(series, first, count, numbers)) {
      take(numbers);
    } else {
      damaged += count;
    }
  }
  return damaged;
}

}  // namespace

std::uint64_t RunKept::rows() const {
  std::uint64_t sum = 0;
  for (const SeriesAudit& audit : series) sum += audit.rows;
  return sum;
}

RunKept finish_run_file(const std::filesystem::path& file, const RunEnd& end) {
  RunKept kept;
  const RunReader from(file);
  RunIdentity identity = from.identity();
  for (const auto& [name, figure] : end.figures) identity.figures[name] = figure;
  for (const auto& [name, word] : end.words) identity.words[name] = word;
  ClosedFile to(file, identity, end.state);
  std::vector<std::filesystem::path> rings;
  std::vector<SeriesData> last;
  for (std::size_t n = 0; n < from.series().size(); ++n) {
    const RunReader::Series& series = from.series()[n];
    const std::size_t there = to.add(series.schema);
    std::optional<RowRing::Left> left;
    if (end.state == RunState::kRecovered && !series.ring.empty()) {
      left = RowRing::read(series.ring, series.schema.width());
      rings.push_back(series.ring);
    }
    // Rows behind the acknowledged ones may be there or not; the memory has all of them.
    const std::uint64_t rows = left ? std::min(series.rows, left->elsewhere) : series.rows;
    kept.damaged_rows +=
        read_pieces(from, n, rows, [&](const std::vector<double>& numbers) { to.append(there, numbers); });
    // By name: a file lists its groups in the alphabet's order, whatever order they were made in.
    const auto never = end.dropped.find(series.schema.name);
    std::uint64_t dropped = series.dropped_rows + (never != end.dropped.end() ? never->second : 0);
    if (left) {
      to.append(there, left->numbers);
      kept.rows_from_memory += left->numbers.size() / series.schema.width();
      kept.overwritten_rows += left->overwritten;
      dropped += left->overwritten;
      last.push_back({series.schema, std::move(left->last)});
    }
    to.set_dropped(there, dropped);
  }
  for (const RunEvent& event : from.events()) {
    to.append(event);
    ++kept.events;
  }
  for (const RunContour& contour : from.contours()) {
    to.append(contour);
    ++kept.contours;
  }
  kept.memory = !last.empty();
  if (!last.empty())
    write_flight(file.parent_path() / ("flight-" + identity.role + "-killed.h5"), identity, last,
                 {.kind = "fault", .text = "the process was killed"});
  kept.series = to.finish();
  for (const std::filesystem::path& ring : rings) {
    std::error_code ignored;
    std::filesystem::remove(ring, ignored);
  }
  return kept;
}

}  // namespace telekerf
