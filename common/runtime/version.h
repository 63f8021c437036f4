// SPDX-License-Identifier: Apache-2.0
// The version of the programs and of the wire contract.
#pragma once

#include <cstdint>

namespace telekerf {

inline constexpr const char* kVersion = TELEKERF_VERSION;
/// Changes whenever a wire type changes its meaning; processes of different contracts refuse each other.
inline constexpr std::uint16_t kContractVersion = 4;

}  // namespace telekerf
