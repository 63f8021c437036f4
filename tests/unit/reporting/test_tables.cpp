// SPDX-License-Identifier: Apache-2.0
// What a table shows of a result, and what it leaves out.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "common/reporting/tables.h"

namespace telekerf::reporting {
namespace {

nlohmann::ordered_json work() {
  return nlohmann::ordered_json::parse(R"({
    "controller": "auto", "corner": "rounded", "drive": {"name": "simulated", "tool": "true"},
    "contours": 7, "contours_cut": 7, "length_mm": 123.456,
    "contour_error_um": {"rms": 1.25, "max": 9.0}, "normal_error_um": {"rms": 1.0, "max": 2.0},
    "tangential_error_um": {"rms": 3.0, "max": 4.0},
    "tangential_speed": {"commanded_mm_s": 8.0, "mean_mm_s": 7.99, "ripple_percent": 0.5},
    "corners": 0, "corner_error_um": 0.0, "closure_gap_um": null, "limit_violations": 0,
    "time_s": 20.0, "time_estimate_s": 19.5,
    "burn": {"material": "wood", "depth_um": 300.0, "depth_variation_percent": 2.0, "kerf_um": 110.0,
             "energy_inside_j": 150.0, "energy_outside_corridor_j": 0.0}})");
}

TEST(Tables, OfAMachiningAreShortAndSayWhatMatters) {
  const std::string table = work_table(work());
  for (const char* said : {"7 of 7 cut, 123.5 mm", "rms 1.2 um, max 9.0 um", "7.99 of 8.00 mm/s", "wood",
                           "150.00 J inside the corridor, 0.00 J outside", "20.0 s, 19.5 s were estimated"})
    EXPECT_NE(table.find(said), std::string::npos) << said << "\n" << table;
  EXPECT_LE(std::count(table.begin(), table.end(), '\n'), 12) << table;
  EXPECT_EQ(table.find('{'), std::string::npos) << "no JSON\n" << table;
}

TEST(Tables, WhatDidNotHappenHasNoRow) {
  nlohmann::ordered_json result = work();
  for (const char* row : {"corners  ", "end to start", "at a limit", "nobody knows"})
    EXPECT_EQ(work_table(result).find(row), std::string::npos) << row;
  result["corners"] = 4;
  result["closure_gap_um"] = 2.0;
  result["limit_violations"] = 3;
  result["drive"] = {{"name", "udp:host:7000"}, {"tool", "measured"}};
  for (const char* row : {"corners  ", "end to start", "at a limit", "measured by udp:host:7000"})
    EXPECT_NE(work_table(result).find(row), std::string::npos) << row;
}

TEST(Tables, OfAMachiningSayEachFigureInItsRow) {
  nlohmann::ordered_json result = work();
  result["corners"] = 4;
  result["corner_error_um"] = 8.26;
  result["closure_gap_um"] = 2.04;
  result["limit_violations"] = 3;
  const std::string table = work_table(result);
  const std::string expected =
      table_row("contours", "7 of 7 cut, 123.5 mm") + table_row("law", "auto, corners rounded") +
      table_row("tool to contour", "rms 1.2 um, max 9.0 um") +
      table_row("across the path", "rms 1.0 um, max 2.0 um") +
      table_row("along the path", "rms 3.0 um, max 4.0 um") +
      table_row("corners", "4, missed by 8.3 um at the most") + table_row("end to start", "2.0 um") +
      table_row("speed", "7.99 of 8.00 mm/s, ripple 0.50 %") +
      table_row("mark", "wood: 300 um deep, off by 2.0 % at the most; kerf 110 um") +
      table_row("laser energy", "150.00 J inside the corridor, 0.00 J outside") +
      table_row("at a limit", "3 ticks") + table_row("time", "20.0 s, 19.5 s were estimated");
  EXPECT_EQ(table, expected);
  EXPECT_EQ(table_row("time", "1 s"), "  time" + std::string(30, ' ') + "1 s\n") << "values below each other";
}

TEST(Tables, OfARunSayEachFigureInItsRow) {
  nlohmann::ordered_json run = nlohmann::ordered_json::parse(R"({
    "contour": {"points": 400, "length_m": 0.06283, "closed": true},
    "drive": {"master": {"name": "simulated", "tool": "true"}, "slave": {"name": "simulated", "tool": "true"}},
    "constraint": {"rms_um": 1.24, "max_um": 5.0}, "tracking": {"rms_um": 2.0, "max_um": 6.0},
    "cut": {"rms_um": 3.0, "max_um": 7.0, "coverage": 0.987, "energy_inside_j": 12.345,
            "energy_outside_corridor_j": 0.001},
    "link": {"rtt_ms": {"p50": 40.0, "p95": 50.0, "p99": null}, "total_ms": 66.0,
             "payload_bytes_per_s": 4321.4, "packets_per_s": 62.5, "lost": 3},
    "codec": {"bits_per_sample": 5.678}})");
  EXPECT_EQ(
      run_table(run),
      table_row("contour", "400 points, 62.8 mm, closed") +
          table_row("constraint (master to contour)", "rms 1.2 um, max 5.0 um") +
          table_row("tracking (slave to master)", "rms 2.0 um, max 6.0 um") +
          table_row("cut (laser to contour)", "rms 3.0 um, max 7.0 um") + table_row("coverage", "98.7 %") +
          table_row("laser energy", "12.35 J inside the corridor, 0.00 J outside") +
          table_row("round trip", "p50 40.0 ms, p95 50.0 ms, p99 - ms; with blocks and play-out 66.0 ms") +
          table_row("command stream", "4321 bytes/s payload in 62.5 packets/s, 5.68 bits a sample, 3 lost"));
  run["contour"]["closed"] = false;
  run["drive"]["slave"] = {{"name", "udp:host:7000"}, {"tool", "measured"}};
  const std::string open = run_table(run);
  EXPECT_EQ(open.find(table_row("contour", "400 points, 62.8 mm, open") +
                      table_row("slave's tool", "as measured by udp:host:7000: nobody knows the true one")),
            0u)
      << open;
}

TEST(Tables, WhatWasNeverMeasuredIsADash) {
  nlohmann::ordered_json result = work();
  result["contour_error_um"]["rms"] = nullptr;
  EXPECT_NE(work_table(result).find("rms - um"), std::string::npos);
}

}  // namespace
}  // namespace telekerf::reporting
