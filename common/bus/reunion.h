// SPDX-License-Identifier: Apache-2.0
// Participants of this cell's identities that were found and have not proved who they are yet, and what makes
// a handshake with them begin anew. Inside the bus only.
//
// After an outage one side may have forgotten the other (its lease has ended) and the other side not. The one
// that has not goes on with the keys of before, and Fast DDS 2.9 answers no new handshake of a participant
// that it holds for authenticated (SecurityManager::process_participant_stateless_message()): the two never
// hear each other again. So whoever waits for a proof says farewell to the other one, as at its end
// (RTPS 2.x, 8.5.3.3): the other one's gate lets nothing more in until it has forgotten who it is, too. Then
// they find each other anew, and the handshake begins on both sides.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include "common/bus/middleware.h"

namespace telekerf::bus {

/// The datagram by which the participant `own` says to `to` alone that it is gone.
std::vector<std::byte> farewell(const std::array<std::uint8_t, 12>& own,
                                const std::array<std::uint8_t, 12>& to);

/// Sends it there; what cannot be sent is not sent.
void send_datagram(std::span<const std::byte> datagram,
                   const std::vector<middleware::rtps::Locator_t>& places);

/// Who waits for a proof, and for how long. Not thread-safe, and without a clock of its own.
class Unproven {
 public:
  using Key = std::array<std::uint8_t, 12>;
  using Time = std::chrono::steady_clock::time_point;
  using Places = std::vector<middleware::rtps::Locator_t>;
  struct Waiting {
    Key key{};
    Places places;  ///< where it hears of others
  };
  /// Until the first farewell: to a participant whose lease has ended before, and to others, whose handshake
  /// has just begun. Each further one waits for twice as long, from kAgain on.
  static constexpr std::chrono::milliseconds kKnownBefore{2500};
  static constexpr std::chrono::milliseconds kNew{6000};
  static constexpr std::chrono::milliseconds kAgain{
      12000};  ///< longer than the other one is deaf, and a handshake

  static constexpr std::chrono::milliseconds kForgotten{30000};

  void found(const Key& key, Places places, Time now);
  /// A handshake with it has failed, which is all that Fast DDS 3 says of one before its proof. Whoever is
  /// known by that alone is forgotten when no other fails for kForgotten.
  void refused(const Key& key, Time now);
  void proved(const Key& key);
  /// `lapsed`: its lease has ended; it has not said farewell.
  void gone(const Key& key, bool lapsed);
  /// Who has waited for long enough at `now`.
  std::vector<Waiting> due(Time now);
  bool empty() const { return waiting_.empty(); }

 private:
  struct Entry {
    Places places;
    Time next;
    std::chrono::milliseconds patience{};
    std::optional<Time> refused;  ///< last, where only that is known of it
  };
  std::map<Key, Entry> waiting_;
  std::set<Key> proved_;
  std::set<Key> lapsed_;
};

/// Watches over them in a thread of its own, and calls `again` with those who are due. Thread-safe.
class Reunion {
 public:
  using Again = std::function<void(const std::vector<Unproven::Waiting>&)>;
  explicit Reunion(Again again);

  void found(const Unproven::Key& key, Unproven::Places places);
  void refused(const Unproven::Key& key);
  void proved(const Unproven::Key& key);
  void gone(const Unproven::Key& key, bool lapsed);
  void clear();  ///< this participant is made anew

 private:
  void run(const std::stop_token& stop);

  Again again_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  Unproven unproven_;
  std::jthread thread_;  ///< last: ends first
};

}  // namespace telekerf::bus
