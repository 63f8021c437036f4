// SPDX-License-Identifier: Apache-2.0
// The two sites. A byte of every participant's GUID prefix names its site, so that a datagram's origin is
// known below DDS (the prefix stands in every RTPS header, at offset 8).
#pragma once

#include <cstdint>

namespace telekerf {

enum class Site : std::uint8_t { kOperator = 0x6d, kSlave = 0x73 };

/// Index into the 12 bytes of the GUID prefix.
inline constexpr int kSiteByte = 2;

/// First octets of the entity ids of stream writers are 0 and this, so that a stream's sample is known as
/// such below DDS, too. No other writer of a process gets there by counting.
inline constexpr std::uint8_t kStreamEntity = 0x53;

}  // namespace telekerf
