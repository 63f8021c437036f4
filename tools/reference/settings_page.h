// SPDX-License-Identifier: Apache-2.0
// The page of settings, out of what the programs say of themselves (`--describe-settings`).
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace telekerf::reference {

/// `programs`: an array of descriptions.
std::string settings_page(const nlohmann::ordered_json& programs);

}  // namespace telekerf::reference
