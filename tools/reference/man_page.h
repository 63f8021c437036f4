// SPDX-License-Identifier: Apache-2.0
// The manual page of a program, from what it says of its settings.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace telekerf::reference {

/// For section 1, in roff. `program`: what `--describe-settings` says.
std::string man_page(const nlohmann::ordered_json& program);

}  // namespace telekerf::reference
