// SPDX-License-Identifier: Apache-2.0
// A record is rows; what a row's columns are stands in one table. Writer, reader, header line and the
// reference page come from it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "common/runtime/vectors.h"

namespace telekerf {

/// What a column's numbers are where a file has types.
enum class ColumnKind { kNumber, kCount, kInteger, kYesNo };

template <typename Row>
struct Column {
  std::string_view name;   ///< in the header line
  std::string_view unit;   ///< empty: a count, or yes (1) and no (0)
  std::string_view frame;  ///< of a position or force, as in docs/glossary.md; empty: it has none
  std::string_view sentence;
  double (*read)(const Row&);
  void (*write)(Row&, double);
  const char* format = "{}";  ///< the shortest text that reads back as the same number
  ColumnKind kind = ColumnKind::kNumber;
};

/// Of a member's type.
template <typename Value>
constexpr ColumnKind kind_of() {
  if constexpr (std::is_same_v<Value, bool>) return ColumnKind::kYesNo;
  if constexpr (std::is_floating_point_v<Value>) return ColumnKind::kNumber;
  if constexpr (std::is_unsigned_v<Value>) return ColumnKind::kCount;
  return ColumnKind::kInteger;
}

/// The column of a member that is one number.
template <auto Member, typename Row>
constexpr Column<Row> column(std::string_view name, std::string_view unit, std::string_view sentence) {
  using Value = std::remove_cvref_t<decltype(std::declval<Row>().*Member)>;
  return {name,
          unit,
          {},
          sentence,
          [](const Row& row) { return static_cast<double>(row.*Member); },
          [](Row& row, double value) {
            if constexpr (std::is_same_v<Value, bool>) {
              row.*Member = value != 0.0;
            } else {
              row.*Member = static_cast<Value>(value);
            }
          },
          "{}",
          kind_of<Value>()};
}

/// The column of one component of a vector.
template <auto Member, int Axis, typename Row>
constexpr Column<Row> component(std::string_view name, std::string_view unit, std::string_view frame,
                                std::string_view sentence) {
  return {name,
          unit,
          frame,
          sentence,
          [](const Row& row) { return (row.*Member)[Axis]; },
          [](Row& row, double value) { (row.*Member)[Axis] = value; }};
}

namespace columns_detail {
void append(std::string& text, const char* format, double value);
std::vector<double> numbers_of(const std::string& line);
std::vector<std::string> lines_of(const std::filesystem::path& file, std::string_view header);
[[noreturn]] void refuse_line(const std::filesystem::path& file, std::size_t line, std::size_t columns);
}  // namespace columns_detail

template <typename Row>
std::string header_of(std::span<const Column<Row>> columns) {
  std::string line;
  for (const auto& column : columns) (line += line.empty() ? "" : ",") += column.name;
  return line;
}

/// The header line and a line for each row.
template <typename Row>
std::string csv_of(std::span<const Column<Row>> columns, std::span<const Row> rows) {
  std::string text = header_of(columns) + "\n";
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i > 0) text += ',';
      columns_detail::append(text, columns[i].format, columns[i].read(row));
    }
    text += '\n';
  }
  return text;
}

/// Throws StartupError that names file and line: it cannot be read, has another header, or a line does not
/// hold a number for each column.
template <typename Row>
std::vector<Row> read_csv(const std::filesystem::path& file, std::span<const Column<Row>> columns) {
  std::vector<Row> rows;
  std::size_t number = 1;
  for (const std::string& line : columns_detail::lines_of(file, header_of(columns))) {
    ++number;
    const std::vector<double> values = columns_detail::numbers_of(line);
    if (values.size() != columns.size()) columns_detail::refuse_line(file, number, columns.size());
    Row row{};
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i].write(row, values[i]);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace telekerf
