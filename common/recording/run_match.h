// SPDX-License-Identifier: Apache-2.0
// Whether the recordings of two sites are of the same run.
#pragma once

#include <filesystem>
#include <span>

#include "common/recording/run_reader.h"

namespace telekerf {

/// Throws StartupError that says in what they differ: the cell, a contour of the same number, virtual or real
/// time, the settings of a virtual run, the master whose blocks the slave received, or the time: rows of both
/// must fall together by the clock comparison of the master (figure `clock_offset_us`), or without one by the
/// dates of both computers, give or take a minute.
void refuse_unrelated(const RunReader& master, const RunReader& slave);

/// Of the recordings that the folders hold of all roles: the master's against the slave's as above; of the others each
/// against the first, by cell, kind of time, and dates (give or take a minute).
void refuse_unrelated(std::span<const std::filesystem::path> folders);

}  // namespace telekerf
