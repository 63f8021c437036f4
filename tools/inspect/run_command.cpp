// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect run FOLDER: the report of a finished run from what its processes recorded.
#include <fmt/format.h>

#include "common/reporting/run_report.h"
#include "tools/inspect/commands.h"

namespace telekerf::inspect {
namespace {

std::string cell(const nlohmann::ordered_json& value, int digits) {
  return value.is_number() ? fmt::format("{:.{}f}", value.get<double>(), digits) : "-";
}

void print_table(const nlohmann::ordered_json& r) {
  const auto line = [](const std::string& what, const std::string& value) {
    fmt::print("  {:<34}{}\n", what, value);
  };
  line("contour", fmt::format("{} points, {} mm, {}", r["contour"]["points"].get<int>(),
                              cell(r["contour"]["length_m"].get<double>() * 1e3, 1),
                              r["contour"]["closed"].get<bool>() ? "closed" : "open"));
  for (const char* site : {"master", "slave"}) {
    const auto& drive = r["drive"][site];
    if (drive["tool"] == "measured") {
      line(fmt::format("{}'s tool", site),
           fmt::format("as measured by {}: nobody knows the true one", drive["name"].get<std::string>()));
    }
  }
  line("constraint (master to contour)",
       fmt::format("rms {} um, max {} um", cell(r["constraint"]["rms_um"], 1),
                   cell(r["constraint"]["max_um"], 1)));
  line("tracking (slave to master)", fmt::format("rms {} um, max {} um", cell(r["tracking"]["rms_um"], 1),
                                                 cell(r["tracking"]["max_um"], 1)));
  line("cut (laser to contour)",
       fmt::format("rms {} um, max {} um", cell(r["cut"]["rms_um"], 1), cell(r["cut"]["max_um"], 1)));
  line("coverage", fmt::format("{:.1f} %", r["cut"]["coverage"].get<double>() * 100));
  line("laser energy",
       fmt::format("{} J inside the corridor, {} J outside", cell(r["cut"]["energy_inside_j"], 2),
                   cell(r["cut"]["energy_outside_corridor_j"], 2)));
  line("round trip", fmt::format("p50 {} ms, p95 {} ms, p99 {} ms; with blocks and play-out {} ms",
                                 cell(r["link"]["rtt_ms"]["p50"], 1), cell(r["link"]["rtt_ms"]["p95"], 1),
                                 cell(r["link"]["rtt_ms"]["p99"], 1), cell(r["link"]["total_ms"], 1)));
  line("command stream",
       fmt::format("{} bytes/s payload in {} packets/s, {} bits a sample, {} lost",
                   cell(r["link"]["payload_bytes_per_s"], 0), cell(r["link"]["packets_per_s"], 1),
                   cell(r["codec"]["bits_per_sample"], 2), r["link"]["lost"].get<int>()));
}

}  // namespace

void add_run_command(Program& program) {
  program.add(
      "run", "Report of a finished run: report.json, trace.csv, cut.png", std::string(),
      [](std::string& folder, Settings& s) {
        s.add("folder", folder, kFolder, "that the run recorded into").as_argument();
      },
      [](const std::string& folder) {
        const RunRecord record = read_run(folder);
        const auto report = reporting::write_report(folder, record);
        print_table(report);
        fmt::print("  {0:<34}{1}/report.json, {1}/cut.png, {1}/trace.csv\n", "files", folder);
        if (reporting::stayed_inside(report)) return 0;
        fmt::print("  {:<34}bad: the laser left the corridor\n", "verdict");
        return 1;
      });
}

}  // namespace telekerf::inspect
