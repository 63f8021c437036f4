// SPDX-License-Identifier: Apache-2.0
#include "netem/drivers/datagram.h"

#include <cstring>

namespace telekerf::netem {
namespace {

// RTPS 2.x, sections 8.3 and 9.4.
constexpr std::size_t kHeader = 20;
constexpr std::size_t kPrefix = 8;  // of the GUID prefix in the header
constexpr std::size_t kSubmessageHeader = 4;
constexpr std::uint8_t kFirstSecure = 0x30;  // SEC_BODY to SRTPS_POSTFIX
constexpr std::uint8_t kLastSecure = 0x34;
constexpr std::uint8_t kData = 0x15;
constexpr std::size_t kDataPayload = kSubmessageHeader + 20;  // without inline QoS
constexpr std::size_t kDataWriter = kSubmessageHeader + 8;
constexpr std::uint8_t kLittleEndian = 0x01;
constexpr std::uint8_t kInlineQos = 0x02;
constexpr std::uint8_t kHasData = 0x04;
constexpr std::size_t kMaxDatagram = 65535;

std::uint8_t octet_at(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<std::uint8_t>(bytes[at]);
}

}  // namespace

std::optional<Site> site_of(std::span<const std::byte> datagram, const SiteTable& sites) noexcept {
  if (datagram.size() < kHeader || std::memcmp(datagram.data(), "RTPS", 4) != 0) return std::nullopt;
  return sites.site_of(datagram.subspan(kPrefix, kHeader - kPrefix));
}

Range stream_payload(std::span<const std::byte> datagram) noexcept {
  if (datagram.size() > kMaxDatagram) return {};
  std::size_t at = kHeader;
  while (at + kSubmessageHeader <= datagram.size()) {
    const std::uint8_t kind = octet_at(datagram, at);
    const std::uint8_t flags = octet_at(datagram, at + 1);
    if (kind >= kFirstSecure && kind <= kLastSecure) return {};
    const unsigned first = octet_at(datagram, at + 2);
    const unsigned second = octet_at(datagram, at + 3);
    const std::size_t length = (flags & kLittleEndian) != 0 ? first | second << 8 : second | first << 8;
    // A length of zero means "to the end" of the datagram.
    const std::size_t end = length == 0 ? datagram.size() : at + kSubmessageHeader + length;
    if (end > datagram.size()) return {};
    if (kind == kData && (flags & kHasData) != 0 && (flags & kInlineQos) == 0 &&
        at + kDataPayload <= end && octet_at(datagram, at + kDataWriter + 1) == kStreamEntity &&
        octet_at(datagram, at + kDataWriter) == 0) {
      return {static_cast<std::uint16_t>(at + kDataPayload), static_cast<std::uint16_t>(end)};
    }
    at = end;
  }
  return {};
}

std::uint8_t parity_outside(std::span<const std::byte> datagram, Range range) noexcept {
  std::byte parity{0};
  for (const std::byte byte : datagram.first(range.begin)) parity ^= byte;
  for (const std::byte byte : datagram.subspan(range.end)) parity ^= byte;
  return std::to_integer<std::uint8_t>(parity);
}

}  // namespace telekerf::netem
