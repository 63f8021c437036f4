// SPDX-License-Identifier: Apache-2.0
#include "netem/drivers/datagram.h"

#include "common/bus/rtps_message.h"

namespace telekerf::netem {
namespace {

// RTPS 2.x, sections 8.3 and 9.4; DDS Security 1.1, 7.3.
constexpr std::uint8_t kFirstSecure = 0x30;  // SEC_BODY to SRTPS_POSTFIX
constexpr std::uint8_t kLastSecure = 0x34;
constexpr std::size_t kDataPayload = bus::kSubmessageHeader + 20;  // without inline QoS
constexpr std::uint8_t kInlineQos = 0x02;
constexpr std::uint8_t kHasData = 0x04;
constexpr std::size_t kMaxDatagram = 65535;

}  // namespace

std::optional<Site> site_of(std::span<const std::byte> datagram, const SiteTable& sites) noexcept {
  if (!bus::is_rtps(datagram)) return std::nullopt;
  return sites.site_of(datagram.subspan(bus::kRtpsPrefix, bus::kRtpsHeader - bus::kRtpsPrefix));
}

Range stream_payload(std::span<const std::byte> datagram) noexcept {
  if (datagram.size() > kMaxDatagram) return {};
  for (std::size_t at = bus::kRtpsHeader; at < datagram.size();) {
    const auto part = bus::submessage(datagram, at);
    if (!part) return {};
    const std::uint8_t kind = bus::octet_at(*part, 0);
    const std::uint8_t flags = bus::octet_at(*part, 1);
    if (kind >= kFirstSecure && kind <= kLastSecure) return {};
    if (bus::is_stream_data(*part) && part->size() >= kDataPayload && (flags & kHasData) != 0 &&
        (flags & kInlineQos) == 0)
      return {static_cast<std::uint16_t>(at + kDataPayload), static_cast<std::uint16_t>(at + part->size())};
    at += part->size();
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
