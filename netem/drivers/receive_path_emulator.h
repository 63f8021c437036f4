// SPDX-License-Identifier: Apache-2.0
// Driver under DDS: every datagram that a participant receives from the other site goes through the emulator,
// and nothing else does. No root, no second program; discovery is delayed like everything.
#pragma once

#include <cstdint>
#include <memory>

#include "common/bus/receive_filter.h"
#include "common/protocol/site.h"
#include "netem/core/profile.h"

namespace telekerf::netem {

struct TransportCounters {
  std::uint64_t emulated = 0;             ///< datagrams from the other site
  std::uint64_t delivered = 0;            ///< of those, handed on (copies included)
  std::uint64_t lost = 0;                 ///< by the profile: loss, events, full queue
  std::uint64_t overflowed = 0;           ///< beyond the emulator's memory: a fault of the set-up
  std::uint64_t corrupted = 0;            ///< damaged by the profile, and
  std::uint64_t delivered_corrupted = 0;  ///< of those, handed on
  std::int64_t earliest_ns = 0;           ///< least of (delivered - due); never below zero
  std::int64_t latest_ns = 0;             ///< most of it: what the machine's scheduling added
};

/// The link into one participant. The slave's site draws from `forward` (operator -> slave), the operator's
/// from `backward`. Thread-safe.
///
/// A damaged datagram reaches the participant only if the damage lies within a stream's payload, where the
/// bus has a checksum of its own to meet; anywhere else UDP's checksum, which no single flipped bit escapes,
/// has the word.
class ReceivePathEmulator : public ReceiveFilter {
 public:
  ReceivePathEmulator(const Profile& profile, std::uint64_t seed, Site own_site);
  ~ReceivePathEmulator() override;

  /// From the next datagram on; what is under way keeps its due time.
  void set_profile(const Profile& profile);
  TransportCounters counters() const;

  std::shared_ptr<Transport> over(std::shared_ptr<Transport> below, const SiteTable& sites) override;

  class State;

 private:
  std::shared_ptr<State> state_;
};

}  // namespace telekerf::netem
