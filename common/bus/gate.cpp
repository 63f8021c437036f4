// SPDX-License-Identifier: Apache-2.0
#include "common/bus/gate.h"

#include <algorithm>
#include <cstring>

#include "common/bus/rtps_message.h"

namespace telekerf::bus {
namespace {

// DDS Security 1.1, 7.3.
constexpr std::uint32_t kHandshakes = 0x000201c3, kKeys = 0xff0202c3;

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

/// May stand unprotected: it addresses, stamps or fills; a vendor's own; or it is protected by itself.
bool is_harmless(std::uint8_t kind) {
  return kind == 0x01 || kind == 0x09 || kind == 0x0e || kind >= 0x80 || (kind >= 0x30 && kind <= 0x32);
}

/// What a datagram is that is not protected.
struct Clear {
  bool refused = false;   ///< not all of it must be sent before there are keys, or it is not whole
  bool farewell = false;  ///< tells of a participant's end
  std::optional<Announcement> announcement;
};

Clear read_clear(std::span<const std::byte> datagram) {
  constexpr std::uint8_t kData = 0x15, kDataFrag = 0x16;
  Clear found;
  for (std::size_t at = kRtpsHeader; at < datagram.size() && !found.refused;) {
    const auto part = submessage(datagram, at);
    if (!part) {
      found.refused = true;
      break;
    }
    const std::uint8_t kind = octet_at(*part, 0);
    const std::size_t writer = writer_at(kind);
    const std::uint32_t entity = writer != 0 && writer + 4 <= part->size() ? entity_at(*part, writer) : 0;
    if (entity == kAnnouncements && kind == kData) {
      found.farewell = found.farewell || is_farewell(*part);
      if (!found.farewell) found.announcement = announcement_in(*part);
      found.refused = !found.farewell && !found.announcement;
    } else if (entity == kAnnouncements) {
      found.refused = kind == kDataFrag;  // nobody's is so long
    } else {
      found.refused = entity != kHandshakes && entity != kKeys && !is_harmless(kind);
    }
    at += part->size();
  }
  return found;
}

template <class Seen>
auto longest_ago(Seen& seen) {
  return std::min_element(seen.begin(), seen.end(), [](const auto& first, const auto& second) {
    return first.heard_ns < second.heard_ns;
  });
}

}  // namespace

Gate::Gate(std::vector<security::SubjectPrefix> known, MessageProtection own) : own_(own) {
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  identities_.resize(known.size());
  for (std::size_t i = 0; i < known.size(); ++i) identities_[i].subject = known[i];
}

bool Gate::admits(std::span<const std::byte> datagram, std::uint32_t from, std::int64_t now_ns) noexcept {
  const Verdict verdict = judge(datagram, from, now_ns);
  if (verdict == Verdict::kRefused) {
    refused_.fetch_add(1, std::memory_order_relaxed);
    refused_from_.store(from, std::memory_order_relaxed);
  }
  return verdict == Verdict::kAdmitted;
}

Gate::Verdict Gate::judge(std::span<const std::byte> datagram, std::uint32_t from,
                           std::int64_t now_ns) noexcept {
  Identity* const identity = identity_of(datagram);
  if (identity == nullptr || datagram.size() < kRtpsHeader + kSubmessageHeader) return Verdict::kRefused;
  Prefix prefix;
  std::memcpy(prefix.data(), datagram.data() + kRtpsPrefix, prefix.size());
  if (has_left(*identity, prefix, now_ns)) return Verdict::kLeft;
  if (is_protected(datagram)) return Verdict::kAdmitted;  // the middleware has the keys, and judges it whole
  const Clear clear = read_clear(datagram);
  if (clear.refused) return Verdict::kRefused;
  if (clear.farewell) {
    take_leave(*identity, prefix, now_ns);
    return Verdict::kLeft;
  }
  if (clear.announcement) {
    const MessageProtection said = clear.announcement->protection;
    if (said == MessageProtection::kNone || clear.announcement->lease_s > kLongestLease_s)
      return Verdict::kRefused;
    if (said != own_) {
      const std::lock_guard lock(mutex_);
      identity->otherwise_ns = now_ns;
      return Verdict::kOtherwise;
    }
  }
  return has_room(*identity, prefix, from, now_ns) ? Verdict::kAdmitted : Verdict::kRefused;
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
  *longest_ago(identity.left) = {prefix, now_ns};
  deaf_until_ns_.store(now_ns + kDeaf_ns, std::memory_order_release);
}

bool Gate::has_room(Identity& identity, const Prefix& prefix, std::uint32_t from,
                    std::int64_t now_ns) noexcept {
  const std::lock_guard lock(mutex_);
  for (Seen& seen : identity.proven) {
    if (seen.heard_ns == 0 || seen.prefix != prefix) continue;
    seen.heard_ns = now_ns;
    return true;
  }
  Trial* room = nullptr;
  for (Trial& trial : identity.unproven) {
    const bool free = trial.heard_ns == 0 || now_ns - trial.heard_ns > kForgotten_ns;
    if (trial.heard_ns != 0 && trial.prefix == prefix) {
      trial.heard_ns = now_ns;
      trial.from = from;
      return true;
    }
    if (free) room = &trial;
  }
  const auto had_its_time = [&](const Seen& seen) {
    return seen.heard_ns != 0 && now_ns - seen.heard_ns < kForgotten_ns;
  };
  auto& rejected = identity.rejected;
  if (std::any_of(rejected.begin(), rejected.end(),
                  [&](const Seen& seen) { return seen.prefix == prefix && had_its_time(seen); }))
    return false;
  if (room == nullptr) {
    room = std::min_element(
        identity.unproven.begin(), identity.unproven.end(),
        [](const Trial& first, const Trial& second) { return first.began_ns < second.began_ns; });
    const auto mark = std::find_if_not(rejected.begin(), rejected.end(), had_its_time);
    if (now_ns - room->began_ns < kTrial_ns || mark == rejected.end()) return false;
    *mark = {room->prefix, now_ns};
  }
  *room = {prefix, now_ns, now_ns, from};
  return true;
}

void Gate::proven(const Prefix& prefix, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  for (Identity& identity : identities_) {
    if (!std::equal(identity.subject.begin(), identity.subject.end(), prefix.begin())) continue;
    const auto known = std::find_if(identity.proven.begin(), identity.proven.end(),
                                    [&](const Seen& seen) { return seen.prefix == prefix; });
    *(known != identity.proven.end() ? known : longest_ago(identity.proven)) = {prefix, now_ns};
    for (Trial& trial : identity.unproven) {
      if (trial.prefix == prefix) trial = {};
    }
  }
}

std::uint32_t Gate::unproven_from(const Prefix& prefix) {
  const std::lock_guard lock(mutex_);
  for (const Identity& identity : identities_) {
    for (const Trial& trial : identity.unproven) {
      if (trial.heard_ns != 0 && trial.prefix == prefix) return trial.from;
    }
  }
  return 0;
}

std::vector<security::SubjectPrefix> Gate::otherwise(std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  std::vector<security::SubjectPrefix> subjects;
  for (const Identity& identity : identities_) {
    if (identity.otherwise_ns != 0 && now_ns - identity.otherwise_ns < kForgotten_ns)
      subjects.push_back(identity.subject);
  }
  return subjects;
}

}  // namespace telekerf::bus
