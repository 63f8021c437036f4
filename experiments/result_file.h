// SPDX-License-Identifier: Apache-2.0
// What every experiment leaves: a JSON file that says which program has made it, and from which seed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/runtime/results.h"
#include "common/runtime/version.h"

namespace telekerf::experiments {

/// Gives `result` its `seed` (of everything random) and `version` and writes it. Throws StartupError: it
/// cannot be written.
inline void write_result(const std::filesystem::path& file, nlohmann::ordered_json& result,
                         std::uint64_t seed) {
  result["seed"] = seed;
  result["version"] = kVersion;
  write_json(file, result);
}

}  // namespace telekerf::experiments
