// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect run FOLDER: the report of a finished run from what its processes recorded.
#include <fmt/format.h>

#include "common/reporting/run_report.h"
#include "common/reporting/tables.h"
#include "tools/inspect/commands.h"

namespace telekerf::inspect {

void add_run_command(Program& program) {
  program.add(
      "run", "Report of a finished run: report.json, trace.csv, cut.png", std::string(),
      [](std::string& folder, Settings& s) {
        s.add("folder", folder, kFolder, "that the run recorded into").as_argument();
      },
      [](const std::string& folder) {
        const RunRecord record = read_run(folder);
        const auto report = reporting::write_report(folder, record);
        const std::string verdict = !reporting::stayed_inside(report) ? "bad: the laser left the corridor"
                                    : reporting::succeeded(report)    ? ""
                                                                      : "bad: nothing was cut";
        fmt::print(
            "{}{}{}", reporting::run_table(report),
            reporting::table_row("files", fmt::format("{0}/report.json, {0}/cut.png, {0}/trace.csv", folder)),
            verdict.empty() ? "" : reporting::table_row("verdict", verdict));
        return verdict.empty() ? 0 : 1;
      });
}

}  // namespace telekerf::inspect
