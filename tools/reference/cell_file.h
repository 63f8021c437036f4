// SPDX-License-Identifier: Apache-2.0
// The file that holds the settings of a cell's services: all of them, explained, none of them set.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace telekerf::reference {

/// `programs`: what `--describe-settings` of each says. Keys that all of them have stand above the tables.
std::string cell_file(const nlohmann::ordered_json& programs);

}  // namespace telekerf::reference
