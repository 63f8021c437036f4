// SPDX-License-Identifier: Apache-2.0
// The claims.json that another run left, as --against reads it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace telekerf::experiments {

/// Its claims, seed and form. Throws StartupError that names file, claim, key and value if it holds what no
/// run writes: a word for a number, a verdict without its figure, an id twice.
nlohmann::ordered_json stored_claims(const std::filesystem::path& folder);

}  // namespace telekerf::experiments
