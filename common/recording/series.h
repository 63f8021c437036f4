// SPDX-License-Identifier: Apache-2.0
// The columns of a table of numbers, without the row behind them: what a file says of itself, so that it is read
// without the program that wrote it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/recording/columns.h"

namespace telekerf {

struct SeriesColumn {
  std::string name;  ///< as in CSV: "tool_x_m"
  std::string unit;
  std::string frame;
  std::string sentence;
  ColumnKind kind = ColumnKind::kNumber;
  bool operator==(const SeriesColumn&) const = default;
};

/// A table that grows during a run: a group of the file.
struct SeriesSchema {
  std::string name;  ///< "master"
  std::vector<SeriesColumn> columns;
  bool every_tick = false;  ///< a row each control step: what is missing is a gap
  std::size_t width() const noexcept { return columns.size(); }
};

/// Rows of a series, one after the other, each schema.width() numbers.
struct SeriesData {
  SeriesSchema schema;
  std::vector<double> numbers;
  std::size_t rows() const noexcept { return schema.width() == 0 ? 0 : numbers.size() / schema.width(); }
  const double* row(std::size_t n) const noexcept { return numbers.data() + n * schema.width(); }
};

/// What a file keeps as one dataset: a column, or the components of a vector ("tool", rows x 3).
struct Quantity {
  std::string name;
  std::size_t first = 0;  ///< its first column
  std::size_t count = 1;
  std::string axes;  ///< "x y z"; empty: no vector
};
/// In the columns' order. A unit's suffix goes, as the unit stands beside it; `t_s` is `time`.
std::vector<Quantity> quantities_of(const SeriesSchema& schema);

template <typename Row>
SeriesSchema schema_of(std::string name, std::span<const Column<Row>> columns, bool every_tick = false) {
  SeriesSchema schema{std::move(name), {}, every_tick};
  for (const Column<Row>& column : columns) {
    schema.columns.push_back({std::string(column.name), std::string(column.unit), std::string(column.frame),
                              std::string(column.sentence), column.kind});
  }
  return schema;
}

/// The rows of a series with columns of `Row`; those that it lacks keep their initial value.
template <typename Row>
std::vector<Row> rows_of(const SeriesData& data, std::span<const Column<Row>> columns) {
  std::vector<Row> rows(data.rows());
  for (const Column<Row>& column : columns) {
    for (std::size_t c = 0; c < data.schema.width(); ++c) {
      if (data.schema.columns[c].name != column.name) continue;
      for (std::size_t n = 0; n < rows.size(); ++n) column.write(rows[n], data.row(n)[c]);
    }
  }
  return rows;
}

/// The other way round.
template <typename Row>
SeriesData series_of(std::string name, std::span<const Column<Row>> columns, std::span<const Row> rows,
                     bool every_tick = false) {
  SeriesData data{schema_of(std::move(name), columns, every_tick), {}};
  data.numbers.reserve(rows.size() * columns.size());
  for (const Row& row : rows)
    for (const Column<Row>& column : columns) data.numbers.push_back(column.read(row));
  return data;
}

}  // namespace telekerf
