// SPDX-License-Identifier: Apache-2.0
// A run's recordings as one MCAP file, on the master's clock.
#pragma once

#include <filesystem>
#include <span>

namespace telekerf::inspect {

/// Rows, blocks' heads and contours as CDR, which names its fields itself (ros2msg); telemetry and what was said
/// as JSON. Throws StartupError.
void write_mcap(const std::filesystem::path& file, std::span<const std::filesystem::path> folders);

}  // namespace telekerf::inspect
