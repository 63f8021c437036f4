// SPDX-License-Identifier: Apache-2.0
// The version of what crosses the network (idl/telekerf.idl).
#pragma once

#include <cstdint>

namespace telekerf {

/// Changes whenever a wire type changes its meaning; processes of different contracts refuse each other.
inline constexpr std::uint16_t kContractVersion = 6;

}  // namespace telekerf
