// SPDX-License-Identifier: Apache-2.0
#include "tools/reference/records_page.h"

#include <fmt/format.h>

#include "common/recording/rows.h"
#include "slave/machining/tool_trace.h"

namespace telekerf::reference {
namespace {

template <typename Row>
std::string table_of(const char* file, const char* what, std::span<const Column<Row>> columns) {
  std::string text = fmt::format(
      "\n## {}\n\n{}\n\n| column | unit | frame | meaning |\n| --- | --- | --- | --- |\n", file, what);
  for (const auto& column : columns)
    text += fmt::format("| `{}` | {} | {} | {} |\n", column.name, column.unit, column.frame, column.sentence);
  return text;
}

}  // namespace

std::string records_page() {
  std::string page =
      "# Columns of records\n\n"
      "What `--record FOLDER` leaves, a line for each control step. Numbers are the shortest that read back "
      "as "
      "the same\ndoubles; yes is 1, no is 0. Where a column has no sentence, the one above it holds for it "
      "as "
      "well. The frames are\nexplained in [the glossary](../glossary.md).\n\n"
      "Written by `build/bin/telekerf-reference build/bin`; a test holds it against the programs.\n";
  page += table_of("master.csv", "The operator's robot, by `telekerf-master`.", master_columns());
  page += table_of("slave.csv", "The robot with the laser, by `telekerf-slave`.", slave_columns());
  page += table_of("contour.csv", "The contour that was cut, by `telekerf-master`.", contour_columns());
  page += table_of("trace.csv", "The tool of automatic machining, by `telekerf-machine`.",
                   machining::tool_trace_columns());
  return page;
}

}  // namespace telekerf::reference
