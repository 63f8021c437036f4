// SPDX-License-Identifier: Apache-2.0
#include "slave/machining/tool_trace.h"

#include <vector>

#include "common/runtime/results.h"

namespace telekerf::machining {
namespace {

using Row = ToolTraceRow;

/// Picometres are enough, and every line is alike.
constexpr Column<Row> in_digits(Column<Row> column, const char* format) {
  column.format = format;
  return column;
}

template <auto Member, int Axis>
constexpr Column<Row> metres(std::string_view name, std::string_view sentence) {
  return in_digits(component<Member, Axis, Row>(name, "m", "workpiece", sentence), "{:.12f}");
}

constexpr Column<Row> kColumns[] = {
    in_digits(column<&Row::t_s, Row>("t_s", "s", "from the first step on"), "{:.7f}"),
    metres<&Row::reference_m, 0>("ref_x_m", "where the tool should be"),
    metres<&Row::reference_m, 1>("ref_y_m", ""),
    metres<&Row::tool_m, 0>("tool_x_m", "true tool, or the measured one where nobody knows it"),
    metres<&Row::tool_m, 1>("tool_y_m", ""),
    metres<&Row::tool_m, 2>("tool_z_m", ""),
    in_digits(column<&Row::laser_w, Row>("laser_w", "W", "power that the laser was told"), "{:.6g}"),
};

}  // namespace

std::span<const Column<Row>> tool_trace_columns() { return kColumns; }

void write_tool_trace(const std::filesystem::path& file, double period_s, std::size_t count,
                      const std::function<Row(std::size_t)>& row) {
  std::vector<Row> rows;
  rows.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    rows.push_back(row(i));
    rows.back().t_s = static_cast<double>(i) * period_s;
  }
  write_atomically(file, csv_of<Row>(kColumns, rows));
}

}  // namespace telekerf::machining
