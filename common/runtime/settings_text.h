// SPDX-License-Identifier: Apache-2.0
// What settings look like: as help, as the file that --config reads, and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/runtime/setting.h"

namespace telekerf {

std::string help_text(const std::vector<Setting>& settings);
/// With their initial values.
std::string toml_text(const std::vector<Setting>& settings);
nlohmann::ordered_json json_of(const std::vector<Setting>& settings);

}  // namespace telekerf
