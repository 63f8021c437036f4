// SPDX-License-Identifier: Apache-2.0
// What a participant's announcement says in the clear (RTPS 2.x, 8.5.3 and 9.6; DDS Security 1.1, 7.4.1.6).
// Inside the bus only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace telekerf::bus {

/// Entity of the writer by which participants announce themselves.
inline constexpr std::uint32_t kAnnouncements = 0x000100c2;

/// How the messages of a participant are protected as a whole.
enum class MessageProtection : std::uint8_t { kNone, kSigned, kEncrypted };

struct Announcement {
  MessageProtection protection = MessageProtection::kNone;
  std::int64_t lease_s = 100;  ///< until it is forgotten, rounded up; 100 where it says nothing
};

/// Of a DATA submessage of kAnnouncements; nullopt: it is not whole, or holds none.
std::optional<Announcement> announcement_in(std::span<const std::byte> submessage) noexcept;

/// A DATA submessage of kAnnouncements that tells of the participant's end (9.6.3.9: the status in its inline
/// QoS).
bool is_farewell(std::span<const std::byte> submessage) noexcept;

}  // namespace telekerf::bus
