// SPDX-License-Identifier: Apache-2.0
#include "tools/reference/records_page.h"

#include <fmt/format.h>

#include "common/recording/rows.h"
#include "common/recording/run_tables.h"
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
      "What a process records, a line for each control step. Text (`--record FOLDER`, `telekerf-inspect run "
      "--csv`) has these\ncolumns, the numbers being the shortest that read back as the same doubles; yes is 1, "
      "no is 0. In the recording itself,\nHDF5, the same columns are datasets: "
      "[recording.md](recording.md). Where a column has no sentence, the one above it\nholds for it as well. "
      "The frames are explained in [the glossary](../glossary.md).\n\n"
      "Written by `build/bin/telekerf-reference build/bin`; a test holds it against the programs.\n";
  page += table_of("master.csv", "The operator's robot, by `telekerf-master`.", master_columns());
  page += table_of("slave.csv", "The robot with the laser, by `telekerf-slave`.", slave_columns());
  page += table_of("blocks, in either recording", "The heads of the blocks that it sends and hears.", block_columns());
  page += table_of("guards, in slave.h5", "What forbids the beam, where it changes.", guard_columns());
  page += table_of("operator, in master.h5, vision.h5 and console.h5", "What each of them heard (the console: sent) of an operator.", operator_columns());
  page += table_of("in_force, in either recording", "Which contour was in force.", in_force_columns());
  page += table_of("contour.csv", "The contour that was cut, by `telekerf-master`.", contour_columns());
  page += table_of("trace.csv", "The tool of automatic machining, by `telekerf-machine`.",
                   machining::tool_trace_columns());
  return page;
}

}  // namespace telekerf::reference
