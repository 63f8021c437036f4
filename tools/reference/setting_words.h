// SPDX-License-Identifier: Apache-2.0
// What a program says of one setting (`--describe-settings`), in plain words.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace telekerf::reference {

/// What is written behind the flag: "NUMBER, mm", "FILE", "anchored|local"; empty: nothing.
std::string value_of(const nlohmann::ordered_json& setting);
/// "1 to 10", "at least 1"; empty: anything goes.
std::string range_of(const nlohmann::ordered_json& setting);
/// Empty: none.
std::string default_of(const nlohmann::ordered_json& setting);

}  // namespace telekerf::reference
