// SPDX-License-Identifier: Apache-2.0
// The little that the emulated link reads of an RTPS datagram: whose it is, and where a stream's payload
// lies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/protocol/site.h"

namespace telekerf::netem {

/// The sender's site; nullopt: not RTPS, or of neither.
std::optional<Site> site_of(std::span<const std::byte> datagram, const SiteTable& sites) noexcept;

struct Range {
  std::uint16_t begin = 0;
  std::uint16_t end = 0;  ///< begin == end: none
};

/// The serialized payload of the first DATA submessage that a stream writer (site.h, kStreamEntity) sent. None in what DDS Security
/// protects: there a damaged octet makes the whole worthless.
Range stream_payload(std::span<const std::byte> datagram) noexcept;

/// Exclusive or of all octets outside `range`: a single flipped bit always shows in it.
std::uint8_t parity_outside(std::span<const std::byte> datagram, Range range) noexcept;

}  // namespace telekerf::netem
