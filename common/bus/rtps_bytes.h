// SPDX-License-Identifier: Apache-2.0
// What both ends of the transport know of a datagram's bytes: RTPS 2.x, 8.3 and 9.4. Inside the bus only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace telekerf::bus {

inline constexpr std::size_t kHeader = 20;
inline constexpr std::size_t kSubmessageHeader = 4;
inline constexpr std::uint8_t kLittleEndian = 0x01;

inline std::uint8_t octet_at(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<std::uint8_t>(bytes[at]);
}

}  // namespace telekerf::bus
