// SPDX-License-Identifier: Apache-2.0
// What the network did to each block of a recorded run, as both sites' recordings show it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/recording/run_tables.h"
#include "netem/core/profile.h"

namespace telekerf::experiments {

/// One block that was sent.
struct RecordedBlock {
  std::uint64_t tick = 0;  ///< of its sender, since the sender's first row
  double delay_s = 0.0;    ///< until the other site had it, at least 0
  bool lost = false;       ///< the other site has no row of it
};

/// `sent`, `heard`: the `blocks` of the sender and of the receiver, those of the other direction among them.
/// `from_tick`: the sender's first row. `later_s`: the receiver's clock against the sender's. Of a block that
/// came twice the first counts.
std::vector<RecordedBlock> recorded_blocks(std::span<const BlockRow> sent, std::span<const BlockRow> heard,
                                           std::uint64_t from_tick, double later_s);

/// The same as a recording for the emulator: a block that is sent within half a block's time of a recorded
/// one fares as that. `start_s`, `period_s`: of the sender's control loop in the replay. Empty: none was
/// sent.
netem::Recording trace_of(std::span<const RecordedBlock> blocks, double start_s, double period_s);

}  // namespace telekerf::experiments
