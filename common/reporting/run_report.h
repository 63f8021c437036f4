// SPDX-License-Identifier: Apache-2.0
// From the record of a run to its report: the measures, the trace, and the picture of the cut.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/recording/run_record.h"

namespace telekerf::reporting {

/// The report (names: README.md, "What a run leaves"). Pure: same record, same bytes.
nlohmann::ordered_json make_report(const RunRecord& record);

/// The laser burnt nothing beyond the corridor.
bool stayed_inside(const nlohmann::ordered_json& report);
/// The verdict on a run: something was cut, and nothing beyond the corridor.
bool succeeded(const nlohmann::ordered_json& report);

/// report.json, trace.csv and cut.png into `folder`; returns the report. Throws StartupError.
nlohmann::ordered_json write_report(const std::filesystem::path& folder, const RunRecord& record);

}  // namespace telekerf::reporting
