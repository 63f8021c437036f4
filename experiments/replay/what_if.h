// SPDX-License-Identifier: Apache-2.0
// What may be asked of a replay: settings that change something of it, and a folder of its own.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/runtime/config.h"
#include "common/runtime/setting.h"

namespace telekerf::experiments {

/// Throws StartupError if `wanted` names a setting of `known` that the recording stands for
/// (a condition on LapOptions::kReplays), and another value than `recorded` has.
void refuse_recorded(std::span<const Setting> known, const ConfigFile& recorded, const ConfigFile& wanted);

/// Throws StartupError if the run shall last longer than the hand was recorded, s.
void refuse_beyond_end(double duration_s, double recorded_s);

/// Throws StartupError if `out` is, or lies in, one of the run's folders, or holds files and no earlier
/// replay.
void refuse_taken_folder(const std::string& out, std::span<const std::filesystem::path> run);

}  // namespace telekerf::experiments
