// SPDX-License-Identifier: Apache-2.0
// Results as one reads them on a terminal; all of it is in the JSON beside.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace telekerf::reporting {

/// A line of a table: what, and its value.
std::string table_row(const std::string& what, const std::string& value);

/// Of a run's report.json (run_report.h).
std::string run_table(const nlohmann::ordered_json& report);
/// Of a machining's result.json.
std::string work_table(const nlohmann::ordered_json& result);

}  // namespace telekerf::reporting
