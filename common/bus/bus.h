// SPDX-License-Identifier: Apache-2.0
// A process' place in its cell: one DDS participant. Readers and writers (endpoints.h) live on it.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/receive_filter.h"
#include "common/protocol/contract_version.h"
#include "common/protocol/presence.h"
#include "common/protocol/site.h"

namespace telekerf {

struct BusSettings {
  int domain = 0;               ///< 0..232
  std::string cell = "cell-1";  ///< several cells share a domain without meeting
  Site site = Site::kOperator;
  std::string role;                ///< "master", "slave", "vision", "console", ...
  std::string name;                ///< unique in the cell; empty: the role
  std::uint32_t epoch = 0;         ///< of this start of the process; higher than the last one's
  std::vector<std::string> peers;  ///< hosts beyond the reach of multicast
  std::string security;            ///< folder of the cell's keys (security/keystore.h); empty: not secured
  bool wan = false;                ///< with security: encrypted, not only signed
  bool outside = true;             ///< without security: heard and seen beyond this computer, too
  std::shared_ptr<ReceiveFilter> receive_filter;  ///< null: none
  /// How long a process looks for others before it joins.
  std::chrono::milliseconds discovery_wait{1000};
  std::uint16_t contract = kContractVersion;  ///< another value only to test refusals
};

/// What is wrong with the name of a cell, and with one of `peers`; empty: nothing.
std::string complaint_about_cell(const std::string& cell);
std::string complaint_about_peer(const std::string& peer);

struct BusCounters {
  std::uint64_t incompatible = 0;  ///< processes that came after us and did not fit
  std::uint64_t strangers = 0;     ///< participants that said what is not theirs to say
  std::uint64_t refused = 0;       ///< datagrams that came without keys of this cell (with security)
};

class Bus {
 public:
  /// Announces itself, looks for others for `discovery_wait`, joins. Throws StartupError: settings out of
  /// range, a peer that does not resolve, no participant to be had, or somebody in the cell whom it does not
  /// fit (presence.h).
  explicit Bus(BusSettings settings);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  const BusSettings& settings() const;
  /// Everyone else in the cell who is alive, as announced.
  std::vector<PresenceMessage> others() const;
  /// The same, and from which computer.
  struct Seen {
    PresenceMessage presence;
    std::string address;  ///< IPv4
  };
  std::vector<Seen> seen() const;
  /// Waits until somebody of this role has joined. False: nobody came in time.
  [[nodiscard]] bool wait_for_role(const std::string& role, std::chrono::nanoseconds timeout) const;
  /// What the user should know about the environment, one sentence each, e.g. clipped socket buffers.
  const std::vector<std::string>& notes() const;
  BusCounters counters() const;
  /// A sentence for each participant that has said what is not theirs to say in this cell, and was not heard:
  /// it has not announced itself here, has another role, or another start's number.
  std::vector<std::string> strangers() const;
  /// Another process that has joined and does not fit beside this one: the two could not see each other
  /// before.
  struct Rival {
    std::string sentence;         ///< what does not fit, with its remedy
    bool we_come_second = false;  ///< see presence.h
  };
  std::optional<Rival> rival() const;
  /// Processes that have announced themselves in other cells of the domain.
  std::vector<PresenceMessage> elsewhere() const;
  /// Who is there but cannot be heard, because it protects its messages otherwise, in a sentence with the
  /// remedy; empty: nobody.
  std::string unheard() const;
  /// Who is let in, in one sentence.
  std::string protection() const;
  /// What is to be told of the dates of this cell's keys, each once. For one thread.
  std::vector<std::string> dates();
  /// Keys that an engagement needs end within seconds: it is to be let go. Without lock.
  bool lets_go() const noexcept;
  /// This process' own have ended, in a sentence; empty: they have not, or there are none.
  std::string ended() const;

  /// The middleware's side of it; complete inside the bus only. Endpoints share its ownership, so the order
  /// of destruction is free.
  class Participant;
  const std::shared_ptr<Participant>& participant() const { return participant_; }

 private:
  std::shared_ptr<Participant> participant_;
};

}  // namespace telekerf
