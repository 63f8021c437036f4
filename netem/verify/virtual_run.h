// SPDX-License-Identifier: Apache-2.0
// Packets sent through an emulator in virtual time, and what became of each.
#pragma once

#include <cstdint>
#include <vector>

#include "netem/core/emulator.h"
#include "netem/core/profile.h"
#include "netem/core/random.h"

namespace telekerf::netem {

/// Packets of one size at a constant rate.
struct Traffic {
  std::uint64_t packets = 1'000'000;
  std::uint64_t seed = 1;  ///< of the emulator's decisions
  double rate_hz = 1000.0;
  std::uint32_t packet_bytes = 200;
};

/// A packet and what was decided for it.
struct Sent {
  std::int64_t in_ns = 0;
  PacketOutcome outcome;
};

/// Everything that one run leaves behind.
struct Run {
  std::vector<Sent> sent;
  std::uint64_t early = 0;         ///< came before its due time
  std::uint64_t altered = 0;       ///< came with another due time than decided
  std::uint64_t out_of_order = 0;  ///< came after a packet that was sent later
  std::uint64_t kept = 0;
  double delivered_mean_s = 0.0;
  Counters counters;
};

/// Every delivery is taken at its deadline.
Run run(const DirectionProfile& profile, Direction direction, const Traffic& traffic);

}  // namespace telekerf::netem
