// SPDX-License-Identifier: Apache-2.0
#include "common/bus/announcement.h"

#include "common/bus/rtps_message.h"

namespace telekerf::bus {
namespace {

using Bytes = std::span<const std::byte>;

constexpr unsigned kSentinel = 0x01, kLease = 0x02, kStatus = 0x71, kSecurity = 0x1005;
constexpr std::uint8_t kLittleEndian = 0x01, kHasQos = 0x02, kHasData = 0x04;
constexpr std::size_t kToQos = kSubmessageHeader + 2;  ///< octets from behind this field to the inline QoS
constexpr std::size_t kSerialNumber = kSubmessageHeader + 12;

unsigned half_at(Bytes bytes, std::size_t at, bool little) noexcept {
  const unsigned first = octet_at(bytes, at), second = octet_at(bytes, at + 1);
  return little ? first | second << 8 : second | first << 8;
}

std::uint32_t word_at(Bytes bytes, std::size_t at, bool little) noexcept {
  const std::uint32_t first = half_at(bytes, at, little), second = half_at(bytes, at + 2, little);
  return little ? first | second << 16 : second | first << 16;
}

/// Calls `visit(id, value)` for each parameter of the list at `at`. Where the list ends, behind its sentinel;
/// nullopt: it does not.
template <class Visit>
std::optional<std::size_t> each_parameter(Bytes part, std::size_t at, bool little, Visit visit) noexcept {
  while (at + 4 <= part.size()) {
    const unsigned id = half_at(part, at, little), length = half_at(part, at + 2, little);
    at += 4;
    if (id == kSentinel) return at;
    if (at + length > part.size()) return std::nullopt;
    visit(id, part.subspan(at, length));
    at += length;
  }
  return std::nullopt;
}

/// Where what stands behind the fixed part of DATA begins; nullopt: it is no whole DATA.
std::optional<std::size_t> behind_head(Bytes part) noexcept {
  constexpr std::uint8_t kData = 0x15;
  if (part.size() < kSerialNumber + 8 || octet_at(part, 0) != kData) return std::nullopt;
  return kToQos + 2 + half_at(part, kToQos, (octet_at(part, 1) & kLittleEndian) != 0);
}

MessageProtection protection_of(Bytes value, bool little) noexcept {
  constexpr std::uint32_t kValid = 0x80000000, kWhole = 0x01;  // of both masks: whole messages, encrypted
  if (value.size() < 8) return MessageProtection::kNone;
  const std::uint32_t mask = word_at(value, 0, little), kind = word_at(value, 4, little);
  if ((mask & kValid) == 0 || (mask & kWhole) == 0) return MessageProtection::kNone;
  return (kind & kWhole) != 0 ? MessageProtection::kEncrypted : MessageProtection::kSigned;
}

}  // namespace

std::optional<Announcement> announcement_in(Bytes part) noexcept {
  auto at = behind_head(part);
  if (!at) return std::nullopt;
  const std::uint8_t flags = octet_at(part, 1);
  if ((flags & kHasData) == 0) return std::nullopt;
  if ((flags & kHasQos) != 0) {
    at = each_parameter(part, *at, (flags & kLittleEndian) != 0, [](unsigned, Bytes) {});
    if (!at) return std::nullopt;
  }
  constexpr std::size_t kEncapsulation = 4;
  constexpr unsigned kListLittle = 0x0003;
  if (*at + kEncapsulation > part.size()) return std::nullopt;
  const bool little = half_at(part, *at, false) == kListLittle;
  Announcement found;
  const auto end = each_parameter(part, *at + kEncapsulation, little, [&](unsigned id, Bytes value) {
    if (id == kSecurity) found.protection = protection_of(value, little);
    if (id == kLease && value.size() >= 8)
      found.lease_s = std::int64_t{word_at(value, 0, little)} + (word_at(value, 4, little) != 0 ? 1 : 0);
  });
  return end ? std::optional(found) : std::nullopt;
}

bool is_farewell(Bytes part) noexcept {
  constexpr std::uint8_t kEnded = 0x03;
  const auto at = behind_head(part);
  if (!at) return false;
  const std::uint8_t flags = octet_at(part, 1);
  bool ended = false;
  if ((flags & kHasQos) != 0)
    (void)each_parameter(part, *at, (flags & kLittleEndian) != 0, [&](unsigned id, Bytes value) {
      if (id == kStatus && value.size() >= 4) ended = (octet_at(value, 3) & kEnded) != 0;
    });
  return ended;
}

}  // namespace telekerf::bus
