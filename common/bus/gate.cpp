// SPDX-License-Identifier: Apache-2.0
#include "common/bus/gate.h"

#include <algorithm>
#include <cstring>

#include "common/bus/rtps_message.h"

namespace telekerf::bus {
namespace {

// DDS Security 1.1, 7.3.
constexpr std::uint32_t kAnnouncements = 0x000100c2, kHandshakes = 0x000201c3, kKeys = 0xff0202c3;

/// Where in a submessage the writer's entity id stands; 0: it names none.
std::size_t writer_at(std::uint8_t kind) {
  switch (kind) {
    case 0x15:  // DATA
    case 0x16:  // DATA_FRAG
      return kSubmessageHeader + 8;
    case 0x06:  // ACKNACK
    case 0x07:  // HEARTBEAT
    case 0x08:  // GAP
    case 0x12:  // NACK_FRAG
    case 0x13:  // HEARTBEAT_FRAG
      return kSubmessageHeader + 4;
    default:
      return 0;
  }
}

std::uint32_t entity_at(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t entity = 0;
  for (std::size_t i = 0; i < 4; ++i) entity = entity << 8 | octet_at(bytes, at + i);
  return entity;
}

/// A submessage that tells of a participant's end (RTPS 2.x, 9.6.3.9: the status in DATA's inline QoS).
bool is_farewell(std::span<const std::byte> part) {
  constexpr std::uint8_t kData = 0x15, kHasQos = 0x02;
  constexpr std::size_t kToQos = kSubmessageHeader + 2;
  constexpr std::size_t kWriter = kSubmessageHeader + 8;
  constexpr unsigned kSentinel = 1, kStatus = 0x71, kEnded = 0x03;
  if (octet_at(part, 0) != kData || part.size() < kWriter + 4 || entity_at(part, kWriter) != kAnnouncements)
    return false;
  const std::uint8_t flags = octet_at(part, 1);
  if ((flags & kHasQos) == 0) return false;
  const bool little = (flags & 1U) != 0;
  const auto half = [&](std::size_t at) -> unsigned {
    const unsigned first = octet_at(part, at), second = octet_at(part, at + 1);
    return little ? first | second << 8 : second | first << 8;
  };
  for (std::size_t at = kToQos + 2 + half(kToQos); at + 4 <= part.size();) {
    const unsigned parameter = half(at), length = half(at + 2);
    if (parameter == kSentinel) return false;
    if (parameter == kStatus && at + 8 <= part.size()) return (octet_at(part, at + 7) & kEnded) != 0;
    at += 4 + length;
  }
  return false;
}

bool holds_farewell(std::span<const std::byte> datagram) {
  for (std::size_t at = kRtpsHeader; at < datagram.size();) {
    const auto part = submessage(datagram, at);
    if (!part) return false;
    if (is_farewell(*part)) return true;
    at += part->size();
  }
  return false;
}

/// May stand unprotected: it addresses, stamps or fills; a vendor's own; or it is protected by itself.
bool is_harmless(std::uint8_t kind) {
  return kind == 0x01 || kind == 0x09 || kind == 0x0e || kind >= 0x80 || (kind >= 0x30 && kind <= 0x32);
}

/// All of it is what must be sent before there are keys.
bool comes_before_keys(std::span<const std::byte> datagram) {
  for (std::size_t at = kRtpsHeader; at < datagram.size();) {
    const auto part = submessage(datagram, at);
    if (!part) return false;
    const std::uint8_t kind = octet_at(*part, 0);
    if (const std::size_t writer = writer_at(kind); writer != 0) {
      if (writer + 4 > part->size()) return false;
      const std::uint32_t entity = entity_at(*part, writer);
      if (entity != kAnnouncements && entity != kHandshakes && entity != kKeys) return false;
    } else if (!is_harmless(kind)) {
      return false;
    }
    at += part->size();
  }
  return true;
}

}  // namespace

Gate::Gate(std::vector<security::SubjectPrefix> known) {
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  identities_.resize(known.size());
  for (std::size_t i = 0; i < known.size(); ++i) identities_[i].subject = known[i];
}

bool Gate::admits(std::span<const std::byte> datagram, std::uint32_t from, std::int64_t now_ns) noexcept {
  const Verdict verdict = judge(datagram, now_ns);
  if (verdict == Verdict::kRefused) {
    refused_.fetch_add(1, std::memory_order_relaxed);
    refused_from_.store(from, std::memory_order_relaxed);
  }
  return verdict == Verdict::kAdmitted;
}

Gate::Verdict Gate::judge(std::span<const std::byte> datagram, std::int64_t now_ns) noexcept {
  Identity* const identity = identity_of(datagram);
  if (identity == nullptr || datagram.size() < kRtpsHeader + kSubmessageHeader) return Verdict::kRefused;
  Prefix prefix;
  std::memcpy(prefix.data(), datagram.data() + kRtpsPrefix, prefix.size());
  if (has_left(*identity, prefix, now_ns)) return Verdict::kLeft;
  if (is_protected(datagram)) return Verdict::kAdmitted;  // the middleware has the keys, and judges it whole
  if (!comes_before_keys(datagram)) return Verdict::kRefused;
  if (holds_farewell(datagram)) {
    take_leave(*identity, prefix, now_ns);
    return Verdict::kLeft;
  }
  return has_room(*identity, prefix, now_ns) ? Verdict::kAdmitted : Verdict::kRefused;
}

Gate::Identity* Gate::identity_of(std::span<const std::byte> datagram) noexcept {
  if (!is_rtps(datagram)) return nullptr;
  security::SubjectPrefix subject;
  std::memcpy(subject.data(), datagram.data() + kRtpsPrefix, subject.size());
  const auto at =
      std::lower_bound(identities_.begin(), identities_.end(), subject,
                       [](const Identity& each, const auto& wanted) { return each.subject < wanted; });
  return at == identities_.end() || at->subject != subject ? nullptr : &*at;
}

bool Gate::has_left(const Identity& identity, const Prefix& prefix, std::int64_t now_ns) noexcept {
  if (now_ns >= deaf_until_ns_.load(std::memory_order_acquire)) return false;  // nearly always
  const std::lock_guard lock(mutex_);
  return std::any_of(identity.left.begin(), identity.left.end(), [&](const Seen& seen) {
    return seen.heard_ns != 0 && seen.prefix == prefix && now_ns - seen.heard_ns < kDeaf_ns;
  });
}

void Gate::take_leave(Identity& identity, const Prefix& prefix, std::int64_t now_ns) noexcept {
  const std::lock_guard lock(mutex_);
  auto* const oldest = std::min_element(
      identity.left.begin(), identity.left.end(),
      [](const Seen& first, const Seen& second) { return first.heard_ns < second.heard_ns; });
  *oldest = {prefix, now_ns};
  deaf_until_ns_.store(now_ns + kDeaf_ns, std::memory_order_release);
}

bool Gate::has_room(Identity& identity, const Prefix& prefix, std::int64_t now_ns) noexcept {
  const std::lock_guard lock(mutex_);
  if (identity.proven == prefix) return true;
  Seen* room = nullptr;
  for (Seen& seen : identity.unproven) {
    if (seen.heard_ns != 0 && seen.prefix == prefix) {
      seen.heard_ns = now_ns;
      return true;
    }
    if (seen.heard_ns == 0 || now_ns - seen.heard_ns > kForgotten_ns) room = &seen;
  }
  if (room == nullptr) return false;
  *room = {prefix, now_ns};
  return true;
}

void Gate::proven(const Prefix& prefix) {
  const std::lock_guard lock(mutex_);
  for (Identity& identity : identities_) {
    if (!std::equal(identity.subject.begin(), identity.subject.end(), prefix.begin())) continue;
    identity.proven = prefix;
    for (Seen& seen : identity.unproven) {
      if (seen.prefix == prefix) seen = {};
    }
  }
}

}  // namespace telekerf::bus
