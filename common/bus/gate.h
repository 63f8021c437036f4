// SPDX-License-Identifier: Apache-2.0
// What a secured participant lets in at all, decided on the datagram before the middleware keeps anything of
// it. Inside the bus only.
//
// A prefix that no certificate of ours leads to is nobody. What is not protected must be an announcement, a
// handshake or an exchange of keys (DDS Security 1.1, 7.3.7): all else under a known prefix is a forgery,
// whatever the middleware would make of it. Announcements are clear, and cost the middleware memory for as
// long as they say; so that must not be long, and only a few that have not proved who they are may be under
// way for each identity. Where all places are taken, who has not proved it in good time gives way to who
// comes, and is not heard for a while: forgeries that say the same again and again keep nobody out for longer
// than that. One that protects its messages otherwise than this participant would be passed over by the
// middleware without a word: it is remembered, so that people can be told.
//
// A farewell is not passed on. Fast DDS 2.9 takes a participant away in the thread that has received it,
// holds SecurityManager's lock meanwhile and waits for its thread of events, which may wait for that lock:
// then no thread ever receives again. Instead nothing more of that participant is let in until its lease has
// ended, and the thread of events itself takes it away.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "common/bus/announcement.h"
#include "common/bus/security/roles.h"

namespace telekerf::bus {

class Gate {
 public:
  static constexpr std::size_t kUnproven = 8;                    ///< participants at a time for each identity
  static constexpr std::int64_t kForgotten_ns = 10'000'000'000;  ///< after it was heard last, or gave way
  static constexpr std::int64_t kTrial_ns =
      2'000'000'000;                                   ///< time that nobody takes from it to prove who it is
  static constexpr std::int64_t kLongestLease_s = 20;  ///< that it may ask for: as Fast DDS by itself
  static constexpr std::int64_t kDeaf_ns = 6'500'000'000;  ///< after a farewell: longer than a lease

  using Prefix = std::array<std::uint8_t, 12>;

  /// `own`: how this participant's messages are protected.
  explicit Gate(std::vector<security::SubjectPrefix> known,
                MessageProtection own = MessageProtection::kSigned);

  /// In threads of the middleware; allocates nothing. `from`: IPv4 address of the sender, network order.
  bool admits(std::span<const std::byte> datagram, std::uint32_t from, std::int64_t now_ns) noexcept;
  /// This participant has proved who it is: it no longer counts among those that have not, and gives way to
  /// nobody.
  void proven(const Prefix& prefix, std::int64_t now_ns);

  /// Identities under which somebody has announced itself lately whose messages are protected otherwise.
  std::vector<security::SubjectPrefix> otherwise(std::int64_t now_ns);

  /// IPv4 address, network order, from which one that has not proved who it is was heard last; 0: unknown.
  std::uint32_t unproven_from(const Prefix& prefix);

  std::uint64_t refused() const noexcept { return refused_.load(std::memory_order_relaxed); }
  /// Who sent the last one that was refused; 0: nobody.
  std::uint32_t refused_from() const noexcept { return refused_from_.load(std::memory_order_relaxed); }

 private:
  struct Seen {
    Prefix prefix{};
    std::int64_t heard_ns = 0;  ///< 0: free
  };
  struct Trial {
    Prefix prefix{};
    std::int64_t began_ns = 0;
    std::int64_t heard_ns = 0;  ///< last; 0: free
    std::uint32_t from = 0;     ///< IPv4 address, network order
  };
  struct Identity {
    security::SubjectPrefix subject{};
    std::array<Trial, kUnproven> unproven;
    std::array<Seen, kUnproven> rejected;  ///< and when they gave way
    std::array<Seen, kUnproven> left;      ///< and when they said farewell
    std::array<Seen, kUnproven> proven;    ///< those heard last; others wait their turn among the unproven
    std::int64_t otherwise_ns = 0;  ///< somebody whose messages are protected otherwise was heard; 0: nobody
  };
  /// Whether it has said farewell a short while ago.
  bool has_left(const Identity& identity, const Prefix& prefix, std::int64_t now_ns) noexcept;
  void take_leave(Identity& identity, const Prefix& prefix, std::int64_t now_ns) noexcept;
  enum class Verdict { kAdmitted, kLeft, kOtherwise, kRefused };
  Verdict judge(std::span<const std::byte> datagram, std::uint32_t from, std::int64_t now_ns) noexcept;
  Identity* identity_of(std::span<const std::byte> datagram) noexcept;
  bool has_room(Identity& identity, const Prefix& prefix, std::uint32_t from, std::int64_t now_ns) noexcept;

  MessageProtection own_;
  std::vector<Identity> identities_;            ///< in order of their subjects
  std::mutex mutex_;                            ///< of who is unproven, proven, and who has left
  std::atomic<std::int64_t> deaf_until_ns_{0};  ///< to anybody, at the latest
  std::atomic<std::uint64_t> refused_{0};
  std::atomic<std::uint32_t> refused_from_{0};
};

}  // namespace telekerf::bus
