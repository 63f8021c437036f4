// SPDX-License-Identifier: Apache-2.0
// Pages out of what the programs say of themselves (`--describe-settings`) and of the records' columns.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace telekerf::reference {

/// `programs`: an array of descriptions.
std::string settings_page(const nlohmann::ordered_json& programs);
std::string records_page();
/// One script for bash that completes every program.
std::string bash_completion(const nlohmann::ordered_json& programs);

}  // namespace telekerf::reference
