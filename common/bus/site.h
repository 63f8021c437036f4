// SPDX-License-Identifier: Apache-2.0
// The two sites. A byte of every participant's GUID prefix names its site, so that a datagram's origin is
// known below DDS (the prefix stands in every RTPS header, at offset 8).
#pragma once

#include <cstdint>

namespace telekerf {

enum class Site : std::uint8_t { kOperator = 0x6d, kSlave = 0x73 };

/// Index into the 12 bytes of the GUID prefix.
inline constexpr int kSiteByte = 2;

}  // namespace telekerf
