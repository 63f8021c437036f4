// SPDX-License-Identifier: Apache-2.0
// The version of the programs.
#pragma once

namespace telekerf {

inline constexpr const char* kVersion = TELEKERF_VERSION;

}  // namespace telekerf
