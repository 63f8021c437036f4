// SPDX-License-Identifier: Apache-2.0
// trace.csv of a run: both tools, the reference, the laser, the force and the tick that is applied, a row a
// tick of the slave.
#pragma once

#include <filesystem>

#include "common/recording/run_record.h"

namespace telekerf::reporting {

/// Metres in the workpiece frame, W, N; t_s since the slave's first row. Throws StartupError.
void write_run_trace(const std::filesystem::path& file, const RunRecord& record);

}  // namespace telekerf::reporting
