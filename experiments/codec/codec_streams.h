// SPDX-License-Identifier: Apache-2.0
// The command stream of a whole lap in one codec or another, across the thesis' network: bytes and tracking.
#pragma once

#include <string>
#include <vector>

#include "common/protocol/overhead.h"
#include "common/reporting/page_tables.h"
#include "experiments/delay/delay_trial.h"

namespace telekerf::experiments {

/// One packet of three bare float32 a sample at 1 kHz, with every head; bytes/s.
inline constexpr double kRawBytesPerS = 1000.0 * (kDatagramBytes + 12);

DelayResult coded_run(const HandRecord& hand, const std::string& codec, int block, int redundancy);

/// Length of the lap of the page's table, s.
inline constexpr double kStreamLap_s = 12.0;

/// `stream` of docs/results/codec.md.
reporting::PageTable stream_table(const HandRecord& hand);

}  // namespace telekerf::experiments
