// SPDX-License-Identifier: Apache-2.0
// The flight recorder's file: the last seconds before a fault at full detail, complete at once.
#pragma once

#include <filesystem>
#include <span>

#include "common/recording/run_file.h"

namespace telekerf {

/// A finished file like that of a whole run. Throws h5::Failure.
void write_flight(const std::filesystem::path& file, const RunIdentity& identity,
                  std::span<const SeriesData> last, const RunEvent& event);

}  // namespace telekerf
