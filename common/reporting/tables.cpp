// SPDX-License-Identifier: Apache-2.0
#include "common/reporting/tables.h"

#include <fmt/format.h>

namespace telekerf::reporting {
namespace {

using Json = nlohmann::ordered_json;

/// A number; "-" of what was never measured.
std::string cell(const Json& value, int digits) {
  return value.is_number() ? fmt::format("{:.{}f}", value.get<double>(), digits) : "-";
}

std::string error_row(const std::string& what, const Json& error) {
  return table_row(what, fmt::format("rms {} um, max {} um", cell(error["rms"], 1), cell(error["max"], 1)));
}

}  // namespace

std::string table_row(const std::string& what, const std::string& value) {
  return fmt::format("  {:<34}{}\n", what, value);
}

std::string run_table(const Json& r) {
  std::string table;
  const auto line = [&table](const std::string& what, const std::string& value) {
    table += table_row(what, value);
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
  const Json age = r["link"].value("command_age_ms", Json::object());
  if (age.contains("mean") && age["mean"].is_number() && age["beam"].is_number()) {
    line("age of commands, both ways",
         fmt::format("mean {} ms, max {} ms; light up to {} ms{}", cell(age["mean"], 0), cell(age["max"], 0),
                     cell(age["beam"], 0),
                     age["mean"].get<double>() > age["beam"].get<double>()
                         ? ": this network needs a higher --beam-age-s of the slave"
                         : ""));
  }
  line("command stream",
       fmt::format("{} bytes/s payload in {} packets/s, {} bits a sample, {} lost",
                   cell(r["link"]["payload_bytes_per_s"], 0), cell(r["link"]["packets_per_s"], 1),
                   cell(r["codec"]["bits_per_sample"], 2), r["link"]["lost"].get<int>()));
  return table;
}

std::string work_table(const Json& r) {
  const Json& speed = r["tangential_speed"];
  const Json& burn = r["burn"];
  std::string table;
  table += table_row("contours", fmt::format("{} of {} cut, {} mm", r["contours_cut"].get<int>(),
                                             r["contours"].get<int>(), cell(r["length_mm"], 1)));
  if (const Json& drive = r["drive"]; drive["tool"] == "measured") {
    table += table_row("tool", fmt::format("as measured by {}: nobody knows the true one",
                                           drive["name"].get<std::string>()));
  }
  table += table_row("law", fmt::format("{}, corners {}", r["controller"].get<std::string>(),
                                        r["corner"].get<std::string>()));
  table += error_row("tool to contour", r["contour_error_um"]);
  table += error_row("across the path", r["normal_error_um"]);
  table += error_row("along the path", r["tangential_error_um"]);
  if (r["corners"].get<int>() > 0) {
    table += table_row("corners", fmt::format("{}, missed by {} um at the most", r["corners"].get<int>(),
                                              cell(r["corner_error_um"], 1)));
  }
  if (r["closure_gap_um"].is_number())
    table += table_row("end to start", cell(r["closure_gap_um"], 1) + " um");
  table +=
      table_row("speed", fmt::format("{} of {} mm/s, ripple {} %", cell(speed["mean_mm_s"], 2),
                                     cell(speed["commanded_mm_s"], 2), cell(speed["ripple_percent"], 2)));
  table += table_row("mark", fmt::format("{}: {} um deep, off by {} % at the most; kerf {} um",
                                         burn["material"].get<std::string>(), cell(burn["depth_um"], 0),
                                         cell(burn["depth_variation_percent"], 1), cell(burn["kerf_um"], 0)));
  table += table_row("laser energy",
                     fmt::format("{} J inside the corridor, {} J outside", cell(burn["energy_inside_j"], 2),
                                 cell(burn["energy_outside_corridor_j"], 2)));
  if (r["limit_violations"].get<int>() > 0)
    table += table_row("at a limit", fmt::format("{} ticks", r["limit_violations"].get<int>()));
  table += table_row(
      "time", fmt::format("{} s, {} s were estimated", cell(r["time_s"], 1), cell(r["time_estimate_s"], 1)));
  return table;
}

}  // namespace telekerf::reporting
