// SPDX-License-Identifier: Apache-2.0
// One script for bash that completes every program.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace telekerf::reference {

/// `programs`: an array of descriptions.
std::string bash_completion(const nlohmann::ordered_json& programs);

}  // namespace telekerf::reference
