// SPDX-License-Identifier: Apache-2.0
// The colours that style sheets have names for (CSS Color 4, section 6.1).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace telekerf::vision {

/// "crimson" -> "#dc143c", whatever the letters' case; nothing where it is no name.
std::optional<std::string> named_colour(std::string_view name);

}  // namespace telekerf::vision
