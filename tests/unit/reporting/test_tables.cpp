// SPDX-License-Identifier: Apache-2.0
// What a table shows of a result, and what it leaves out.
#include <gtest/gtest.h>

#include <algorithm>

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

TEST(Tables, WhatWasNeverMeasuredIsADash) {
  nlohmann::ordered_json result = work();
  result["contour_error_um"]["rms"] = nullptr;
  EXPECT_NE(work_table(result).find("rms - um"), std::string::npos);
}

}  // namespace
}  // namespace telekerf::reporting
