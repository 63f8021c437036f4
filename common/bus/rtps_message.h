// SPDX-License-Identifier: Apache-2.0
// The little that is read of an RTPS message below the middleware (RTPS 2.x, 8.3 and 9.4). Inside the bus
// and its receive filters only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

#include "common/protocol/site.h"

namespace telekerf::bus {

inline constexpr std::size_t kRtpsHeader = 20;
inline constexpr std::size_t kRtpsPrefix = 8;  ///< where the sender's GUID prefix begins
inline constexpr std::size_t kSubmessageHeader = 4;

inline std::uint8_t octet_at(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<std::uint8_t>(bytes[at]);
}

inline bool is_rtps(std::span<const std::byte> datagram) {
  return datagram.size() >= kRtpsHeader && std::memcmp(datagram.data(), "RTPS", 4) == 0;
}

/// The submessage at `at`, its head included; none: it is not whole.
inline std::optional<std::span<const std::byte>> submessage(std::span<const std::byte> datagram,
                                                            std::size_t at) {
  constexpr std::uint8_t kLittleEndian = 0x01;
  if (at + kSubmessageHeader > datagram.size()) return std::nullopt;
  const unsigned first = octet_at(datagram, at + 2);
  const unsigned second = octet_at(datagram, at + 3);
  const bool little = (octet_at(datagram, at + 1) & kLittleEndian) != 0;
  const std::size_t length = little ? first | second << 8 : second | first << 8;
  if (length == 0) return datagram.subspan(at);  // to the end
  if (at + kSubmessageHeader + length > datagram.size()) return std::nullopt;
  return datagram.subspan(at, kSubmessageHeader + length);
}

/// The message as a whole is signed or encrypted: it begins with SRTPS_PREFIX (DDS Security 1.1, 7.3.6.3).
inline bool is_protected(std::span<const std::byte> datagram) {
  constexpr std::uint8_t kSecureMessage = 0x33;
  return datagram.size() > kRtpsHeader && octet_at(datagram, kRtpsHeader) == kSecureMessage;
}

/// DATA of one of a stream's writers (site.h).
inline bool is_stream_data(std::span<const std::byte> submessage) {
  constexpr std::uint8_t kData = 0x15;
  constexpr std::size_t kWriterEntity = 12;
  return octet_at(submessage, 0) == kData && submessage.size() > kWriterEntity + 1 &&
         octet_at(submessage, kWriterEntity) == 0 && octet_at(submessage, kWriterEntity + 1) == kStreamEntity;
}

}  // namespace telekerf::bus
